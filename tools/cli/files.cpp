#include "cli/files.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

namespace sinew::cli {

convert::Error check_writable(const std::string& path) {
  std::error_code code;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty() && !std::filesystem::is_directory(parent, code))
    return {path + ": its directory does not exist"};
  if (access(parent.empty() ? "." : parent.c_str(), W_OK) != 0)
    return {path + ": its directory cannot be written to"};
  if (std::filesystem::is_directory(path, code)) return {path + ": is a directory"};
  return {};
}

convert::Error write_atomically(const std::string& path, const void* data, std::size_t size) {
  if (convert::Error error = check_writable(path)) return error;
  const std::string temporary = path + ".tmp" + std::to_string(getpid());
  std::error_code code;
  {
    std::ofstream file(temporary, std::ios::binary);
    file.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    file.close();
    if (!file) {
      std::filesystem::remove(temporary, code);
      return {path + ": cannot be written"};
    }
  }
  std::filesystem::rename(temporary, path, code);
  if (code) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return {path + ": cannot be written: " + code.message()};
  }
  return {};
}

convert::Error write_atomically(const std::string& path, const std::string& text) {
  return write_atomically(path, text.data(), text.size());
}

convert::Error read_json(const std::string& path, nlohmann::json& out) {
  std::ifstream file(path);
  if (!file) return {path + ": file cannot be opened"};
  try {
    out = nlohmann::json::parse(file, nullptr, true, true);
  } catch (const nlohmann::json::exception& e) {
    return {path + ": not JSON: " + e.what()};
  }
  return {};
}

std::function<void(int, int)> progress_bar(const std::string& what) {
  if (!isatty(STDERR_FILENO)) return {};
  const auto begin = std::chrono::steady_clock::now();
  auto shown = std::make_shared<int>(-1);
  return [=](int done, int total) {
    if (total <= 0 || std::chrono::steady_clock::now() - begin < std::chrono::seconds(1)) return;
    const int percent = 100 * done / total;
    if (percent == *shown) return;
    *shown = percent;
    std::fprintf(stderr, "\r%s [%-40s] %3d %%%s", what.c_str(),
                 std::string(static_cast<std::size_t>(percent * 2 / 5), '#').c_str(), percent,
                 done >= total ? "\n" : "");
  };
}

std::string json_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace sinew::cli
