// Runs the `sinew` command as a user does, and keeps what it wrote.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace sinew::test {

struct Outcome {
  int code = -1;
  std::string out;  ///< standard output and error
};

inline Outcome run_program(const std::string& program, const std::string& arguments) {
  Outcome run;
  FILE* pipe = popen((program + " " + arguments + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) run.out.append(buffer, n);
  run.code = WEXITSTATUS(pclose(pipe));
  return run;
}

inline Outcome sinew(const std::string& arguments) {
  return run_program(SINEW_COMMAND, arguments);
}

/// A directory of this process: ctest runs the cases side by side.
inline std::string own_directory() {
  std::string directory = testing::TempDir() + "sinew_command_" + std::to_string(getpid()) + "/";
  std::filesystem::create_directories(directory);
  return directory;
}

inline std::string written(const std::string& name, const std::string& content) {
  std::string path = own_directory() + name;
  std::ofstream(path) << content;
  return path;
}

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Exit code 1 and one line that names what is wrong.
inline void expect_refused(const std::string& arguments, const std::string& names) {
  const Outcome run = sinew(arguments);
  EXPECT_EQ(run.code, 1) << arguments << "\n" << run.out;
  EXPECT_EQ(run.out.rfind("sinew: ", 0), 0u) << run.out;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1) << run.out;
  EXPECT_NE(run.out.find(names), std::string::npos) << run.out;
}

}  // namespace sinew::test
