#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>

#include "import/broker.h"
#include "import/readers.h"
#include "import/sandbox.h"
#include "import/serialize.h"
#include "import/text.h"

namespace sinew::import {
namespace {

constexpr std::size_t kMaxMessage = 400;

}  // namespace

std::string one_line(std::string message) {
  message = clean_text(message);
  if (message.size() > kMaxMessage) {
    std::size_t end = kMaxMessage;
    while ((message[end] & 0xC0) == 0x80) --end;  // not inside a character
    message = message.substr(0, end) + " …";
  }
  while (!message.empty() && message.back() == ' ') message.pop_back();
  return message;
}

std::string read_whole(int file, std::uint64_t most) {
  if (file < 0) throw std::runtime_error("file cannot be opened");
  const std::unique_ptr<const int, void (*)(const int*)> closed(&file, [](const int* f) { ::close(*f); });
  struct stat info {};
  if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) throw std::runtime_error("not a regular file");
  if (std::uint64_t(info.st_size) > most)
    throw std::runtime_error("larger than " + std::to_string(most >> 20) + " MiB");
  if (info.st_size == 0) throw std::runtime_error("file is empty");
  return read_descriptor(file, most);
}

std::string read_descriptor(int descriptor, std::uint64_t most) {
  struct stat info {};
  if (fstat(descriptor, &info) != 0 || std::uint64_t(info.st_size) > most)
    throw std::runtime_error("a file it needs is too large");
  std::string content(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t have = 0;
  while (have < content.size()) {
    const ssize_t n =
        pread(descriptor, content.data() + have, content.size() - have, static_cast<off_t>(have));
    if (n <= 0) throw std::runtime_error("a file it needs cannot be read");
    have += static_cast<std::size_t>(n);
  }
  return content;
}

bool read_source(const std::string& path, const ReadLimits& limits, SourceScene& out, std::string& error) {
  std::string content;
  try {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a FIFO must not block
    content = read_whole(file, limits.max_file_bytes);
  } catch (const std::exception& e) {
    error = e.what();
    return false;
  }
  const std::string format = detect_format(content);
  if (format.empty()) {
    const bool wide = content.rfind("\xFF\xFE", 0) == 0 || content.rfind("\xFE\xFF", 0) == 0;
    error = wide ? "UTF-16 text; save it as UTF-8" : "not a glTF, FBX, BVH, COLLADA or URDF file";
    return false;
  }
  std::set<std::string> asked;
  const auto broker = [&](const std::string& name) {
    asked.insert(clean_text(name));
    return open_beside(path, name, limits.max_file_bytes);
  };
  const auto work = [&](const OpenFile& open_file) {
    check_shape(content, format, limits);
    return to_bytes(format == "urdf" ? read_urdf(content, limits)
                                     : read_with_assimp(content, format, open_file, limits));
  };
  std::string answer, fault;
  if (!run_sandboxed(limits, broker, work, answer, fault) || !from_bytes(answer, out, fault)) {
    error = one_line(fault);
    return false;
  }
  out.files.assign(asked.begin(), asked.end());
  if (out.name.empty()) out.name = clean_text(std::filesystem::path(path).stem().string());
  return true;
}

}  // namespace sinew::import
