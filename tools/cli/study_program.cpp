#include "cli/study_program.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "cli/files.h"
#include "mechanism/format.h"

namespace sinew::cli {
namespace {

bool is_mechanism_file(const char* path) {
  nlohmann::json file;
  return *path != '-' && !read_json(path, file) && mechanism::is_mechanism(file);
}

}  // namespace

bool is_for_study_program(int argc, char** argv) {
  if (argc < 2) return false;
  const std::string_view command = argv[1];
  return command == "study" ||
         (command == "simulate" && std::any_of(argv + 2, argv + argc, is_mechanism_file));
}

int run_study_program(char** argv) {
  std::error_code unknown;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::string program = (here / "sinew-study").string();
  execv(program.c_str(), argv);
  std::fprintf(stderr, "sinew: %s cannot be run: studies and mechanisms need it (target sinew_study_cli)\n",
               program.c_str());
  return 1;
}

}  // namespace sinew::cli
