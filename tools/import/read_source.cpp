#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "import/readers.h"
#include "import/sandbox.h"
#include "import/serialize.h"

namespace sinew::import {
namespace {

constexpr int kMaxSideFiles = 256;
constexpr int kMaxTextNesting = 2000;  ///< brackets; real glTF needs about ten

std::string start_of(const std::string& content) {
  std::size_t at = content.rfind("\xEF\xBB\xBF", 0) == 0 ? 3 : 0;
  while (at < content.size() && std::isspace(static_cast<unsigned char>(content[at]))) ++at;
  return content.substr(at, 4096);
}

/// Regular files beside the source, opened now so that the sandboxed reader needs no path.
SideFiles open_side_files(const std::filesystem::path& source, std::uint64_t most) {
  SideFiles files;
  std::error_code ignored;
  const auto directory = source.has_parent_path() ? source.parent_path() : std::filesystem::path(".");
  for (std::filesystem::recursive_directory_iterator it(directory, ignored), end; it != end;
       it.increment(ignored)) {
    if (ignored || static_cast<int>(files.size()) >= kMaxSideFiles) break;
    if (it.depth() >= 1) it.disable_recursion_pending();
    std::string extension = it->path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), ::tolower);
    if (extension != ".bin" && extension != ".png" && extension != ".jpg" && extension != ".jpeg") continue;
    if (it->is_symlink(ignored) || !it->is_regular_file(ignored) || it->file_size(ignored) > most) continue;
    const int descriptor = ::open(it->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor >= 0) files[it->path().lexically_relative(directory).generic_string()] = descriptor;
  }
  return files;
}

}  // namespace

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

std::string detect_format(const std::string& content) {
  if (content.rfind("glTF", 0) == 0) return "glb";
  if (content.rfind("Kaydara FBX Binary", 0) == 0) return "fbx";
  const std::string start = start_of(content);
  if (start.rfind("; FBX", 0) == 0) return "fbx";
  if (start.rfind("HIERARCHY", 0) == 0) return "bvh";
  if (start.rfind("{", 0) == 0 && content.find("\"asset\"") != std::string::npos) return "gltf";
  if (start.rfind("<", 0) == 0) {
    if (start.find("<COLLADA") != std::string::npos) return "dae";
    if (content.find("<robot") != std::string::npos) return "urdf";
  }
  return {};
}

void check_shape(const std::string& content, const std::string& format, const ReadLimits& limits) {
  if (format == "bvh") {
    int depth = 0, joints = 0;
    for (std::size_t at = 0; at < content.size(); ++at) {
      if (content[at] == '{' && ++depth > limits.max_depth)
        throw std::runtime_error("joints are nested more than " + std::to_string(limits.max_depth) + " deep");
      if (content[at] == '}') --depth;
      if (content.compare(at, 5, "JOINT") == 0 && ++joints > limits.max_nodes)
        throw std::runtime_error("too many joints");
      if (content.compare(at, 6, "MOTION") == 0) break;
    }
    const std::size_t frames = content.find("Frames:");
    if (frames == std::string::npos) throw std::runtime_error("it has no MOTION section with frames");
    const double count = std::strtod(content.c_str() + frames + 7, nullptr);
    if (!(count >= 1) || count > double(content.size()))
      throw std::runtime_error("its number of frames is impossible");
    const std::size_t time = content.find("Frame Time:");
    if (time == std::string::npos || !(std::strtod(content.c_str() + time + 11, nullptr) > 0))
      throw std::runtime_error("its frame time is not positive");
  } else if (format == "gltf") {
    int depth = 0;
    bool quoted = false;
    for (std::size_t at = 0; at < content.size(); ++at) {
      const char c = content[at];
      if (quoted) {
        if (c == '\\') ++at;
        if (c == '"') quoted = false;
      } else if (c == '"') {
        quoted = true;
      } else if ((c == '{' || c == '[') && ++depth > kMaxTextNesting) {
        throw std::runtime_error("its JSON is nested too deeply");
      } else if (c == '}' || c == ']') {
        --depth;
      }
    }
  } else if (format == "urdf" || format == "dae") {
    int depth = 0;
    for (std::size_t at = 0; at + 1 < content.size(); ++at) {
      if (content[at] != '<') continue;
      if (content[at + 1] == '/') {
        --depth;
      } else if (content[at + 1] != '!' && content[at + 1] != '?') {
        const std::size_t end = content.find('>', at);
        if (end == std::string::npos) break;
        if (content[end - 1] != '/' && ++depth > kMaxTextNesting)
          throw std::runtime_error("its XML is nested too deeply");
      }
    }
  }
}

bool read_source(const std::string& path, const ReadLimits& limits, SourceScene& out, std::string& error) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    error = "file cannot be opened";
    return false;
  }
  struct stat info {};
  std::string content;
  try {
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) throw std::runtime_error("not a regular file");
    if (std::uint64_t(info.st_size) > limits.max_file_bytes)
      throw std::runtime_error("larger than " + std::to_string(limits.max_file_bytes >> 20) + " MiB");
    content = read_descriptor(file, limits.max_file_bytes);
  } catch (const std::exception& e) {
    error = e.what();
  }
  ::close(file);
  if (!error.empty()) return false;
  const std::string format = detect_format(content);
  if (format.empty()) {
    error = content.empty() ? "file is empty" : "not a glTF, FBX, BVH, COLLADA or URDF file";
    return false;
  }
  SideFiles side;
  if (format == "gltf" || format == "fbx" || format == "dae")
    side = open_side_files(path, limits.max_file_bytes);
  std::string answer;
  const bool ran = run_sandboxed(
      limits,
      [&] {
        check_shape(content, format, limits);
        return to_bytes(format == "urdf" ? read_urdf(content, limits)
                                         : read_with_assimp(content, format, side, limits));
      },
      answer, error);
  for (const auto& [name, descriptor] : side) ::close(descriptor);
  if (!ran) {
    std::replace(error.begin(), error.end(), '\n', ' ');
    return false;
  }
  if (!from_bytes(answer, out, error)) return false;
  if (out.name.empty()) out.name = std::filesystem::path(path).stem().string();
  return true;
}

}  // namespace sinew::import
