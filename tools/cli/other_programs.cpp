#include "cli/other_programs.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "cli/files.h"
#include "cli/terminal.h"
#include "mechanism/format.h"

namespace sinew::cli {
namespace {

bool is_mechanism_file(const char* path) {
  nlohmann::json file;
  return *path != '-' && !read_json(path, file) && mechanism::is_mechanism(file);
}

std::string beside(const char* program) {
  std::error_code unknown;
  return (std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / program).string();
}

constexpr const char *kRender = "sinew-render", *kStudy = "sinew-study";

}  // namespace

const char* program_for(int argc, char** argv) {
  if (argc < 2) return nullptr;
  const std::string_view command = argv[1];
  if (command == "render") return kRender;
  if (command == "study") return kStudy;
  return command == "simulate" && std::any_of(argv + 2, argv + argc, is_mechanism_file) ? kStudy : nullptr;
}

int become(const char* program, char** argv) {
  const std::string path = beside(program);
  execv(path.c_str(), argv);
  say_error(path + " cannot be run: 'sinew " + argv[1] + "' needs it");
  return 1;
}

std::vector<nlohmann::json> describe_other_programs() {
  std::vector<nlohmann::json> all;
  for (const char* program : {kRender, kStudy}) {
    const std::string path = beside(program);
    if (access(path.c_str(), X_OK) != 0) continue;
    std::string text, quoted;
    for (const char c : path) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    FILE* pipe = popen(("'" + quoted + "' --describe").c_str(), "r");
    if (pipe == nullptr) continue;
    char block[4096];
    for (std::size_t n; (n = fread(block, 1, sizeof block, pipe)) > 0;) text.append(block, n);
    const bool done = pclose(pipe) == 0;
    const nlohmann::json found = nlohmann::json::parse(text, nullptr, false);
    if (done && found.is_object()) all.push_back(found);
  }
  return all;
}

}  // namespace sinew::cli
