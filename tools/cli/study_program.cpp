#include "cli/study_program.h"

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

std::string study_program() {
  std::error_code unknown;
  return (std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / "sinew-study").string();
}

}  // namespace

bool is_for_study_program(int argc, char** argv) {
  if (argc < 2) return false;
  const std::string_view command = argv[1];
  return command == "study" ||
         (command == "simulate" && std::any_of(argv + 2, argv + argc, is_mechanism_file));
}

int run_study_program(char** argv) {
  const std::string program = study_program();
  execv(program.c_str(), argv);
  say_error(program + " cannot be run: studies and mechanisms need it (target sinew_study_cli)");
  return 1;
}

nlohmann::json describe_study_program() {
  if (access(study_program().c_str(), X_OK) != 0) return {};
  std::string text, quoted;
  for (const char c : study_program()) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  FILE* pipe = popen(("'" + quoted + "' --describe").c_str(), "r");
  if (pipe == nullptr) return {};
  char block[4096];
  for (std::size_t n; (n = fread(block, 1, sizeof block, pipe)) > 0;) text.append(block, n);
  const bool done = pclose(pipe) == 0;
  const nlohmann::json found = nlohmann::json::parse(text, nullptr, false);
  return done && found.is_object() ? found : nlohmann::json();
}

}  // namespace sinew::cli
