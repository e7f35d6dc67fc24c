#include "import/broker.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sinew::import {
namespace {

constexpr std::size_t kMaxName = 1024;

/// One byte and perhaps a descriptor, in the layout that sendmsg and recvmsg want.
struct Reply {
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  msghdr header{};

  Reply() {
    header.msg_iov = &data;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof control;
  }
};

}  // namespace

int request_file(int socket, const std::string& name) {
  if (name.empty() || name.size() > kMaxName) return -1;
  if (send(socket, name.data(), name.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(name.size())) return -1;
  Reply reply;
  if (recvmsg(socket, &reply.header, MSG_CMSG_CLOEXEC) != 1) return -1;
  const cmsghdr* passed = CMSG_FIRSTHDR(&reply.header);
  if (!passed || passed->cmsg_level != SOL_SOCKET || passed->cmsg_type != SCM_RIGHTS) return -1;
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(passed), sizeof descriptor);
  return descriptor;
}

bool serve_request(int socket, const std::function<int(const std::string&)>& open_file) {
  std::string name(kMaxName + 1, '\0');
  const ssize_t size = recv(socket, name.data(), name.size(), MSG_DONTWAIT);
  if (size < 0) return errno == EINTR || errno == EAGAIN;
  if (size == 0 || size > static_cast<ssize_t>(kMaxName)) return false;
  name.resize(static_cast<std::size_t>(size));
  const int descriptor = open_file(name);
  Reply reply;
  if (descriptor >= 0) {
    cmsghdr* passed = CMSG_FIRSTHDR(&reply.header);
    passed->cmsg_level = SOL_SOCKET;
    passed->cmsg_type = SCM_RIGHTS;
    passed->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(passed), &descriptor, sizeof descriptor);
  } else {
    reply.header.msg_control = nullptr;
    reply.header.msg_controllen = 0;
  }
  const bool sent = sendmsg(socket, &reply.header, MSG_NOSIGNAL | MSG_DONTWAIT) == 1;
  if (descriptor >= 0) close(descriptor);
  return sent;
}

int open_below(const std::filesystem::path& allowed, const std::string& name, std::uint64_t most) {
  const std::filesystem::path wanted(name);
  if (name.empty() || name.find('\0') != std::string::npos || wanted.is_absolute()) return -1;
  if (std::any_of(wanted.begin(), wanted.end(), [](const auto& part) { return part == ".."; })) return -1;

  std::error_code failed;
  const auto directory = std::filesystem::canonical(allowed, failed);
  if (failed) return -1;
  const auto target = std::filesystem::canonical(directory / wanted, failed);  // links resolved
  if (failed) return -1;
  if (std::mismatch(directory.begin(), directory.end(), target.begin(), target.end()).first !=
      directory.end())
    return -1;

  const int descriptor = ::open(target.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return -1;
  struct stat info {};
  if (fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) && std::uint64_t(info.st_size) <= most)
    return descriptor;
  close(descriptor);
  return -1;
}

int open_beside(const std::filesystem::path& source, const std::string& name, std::uint64_t most) {
  return open_below(source.has_parent_path() ? source.parent_path() : ".", name, most);
}

}  // namespace sinew::import
