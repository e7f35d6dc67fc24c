#include "cli/files.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/terminal.h"
#include "import/plain_words.h"

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

convert::Error check_outputs(const std::vector<std::string>& outputs,
                             const std::vector<std::string>& inputs) {
  const auto same = [](const std::string& a, const std::string& b) {
    std::error_code none;
    return std::filesystem::weakly_canonical(a, none) == std::filesystem::weakly_canonical(b, none) ||
           std::filesystem::equivalent(a, b, none);
  };
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    const std::string& output = outputs[n];
    if (output.empty()) continue;
    for (const std::string& input : inputs)
      if (!input.empty() && same(output, input)) return {output + ": is the input"};
    for (std::size_t other = 0; other < n; ++other)
      if (!outputs[other].empty() && same(output, outputs[other]))
        return {output + ": two outputs cannot be one file"};
    if (convert::Error error = check_writable(output)) return error;
  }
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

convert::Error telemetry_format(const std::string& path, bool& as_json) {
  const std::string ending = std::filesystem::path(path).extension();
  for (const char* picture : {".mp4", ".webm", ".gif", ".png"})
    if (ending == picture)
      return {path + ": telemetry is .csv, or .json for the summary; 'sinew render' makes " + ending};
  as_json = ending == ".json";
  return {};
}

convert::Error read_json(const std::string& path, nlohmann::json& out) {
  std::ifstream file(path);
  if (!file) return {path + ": file cannot be opened"};
  try {
    out = nlohmann::json::parse(file, nullptr, true, true);
  } catch (const nlohmann::json::exception& e) {
    return {path + ": not JSON: " + import::plain_words(e)};
  }
  return {};
}

std::function<void(int, int)> progress_line(const std::string& what) {
  using Clock = std::chrono::steady_clock;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  // Before the first line the pace is not known; what is done sooner needs none.
  const auto pause = terminal ? std::chrono::milliseconds(250) : std::chrono::milliseconds(10000);
  const auto begin = Clock::now();
  auto next = std::make_shared<Clock::time_point>(begin + std::max(pause, std::chrono::milliseconds(1000)));
  auto shown = std::make_shared<bool>(false);
  return [=](int done, int total) {
    const auto now = Clock::now();
    const bool last = done >= total;
    if (is_quiet() || total <= 0 || done <= 0 || (last ? !(terminal && *shown) : now < *next)) return;
    *next = now + pause;
    *shown = true;
    const double left = std::chrono::duration<double>(now - begin).count() * (total - done) / done;
    std::fprintf(stderr, "%s%s %d of %d, %.0f s left%s%s", terminal ? "\r" : "", what.c_str(), done, total,
                 std::ceil(left), terminal ? "\033[K" : "", terminal && !last ? "" : "\n");
  };
}

}  // namespace sinew::cli
