#include "batch/processes.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>

#include "cli/files.h"

extern char** environ;

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;

/// Starts this program with other arguments; −1 where that is not possible.
pid_t start(std::vector<std::string> arguments, const Finished& to, long cpu_seconds) {
  arguments.insert(arguments.begin(), "sinew");
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, to.out.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, to.err.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  pid_t process = -1;
  const int code = posix_spawn(&process, "/proc/self/exe", &actions, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0) return -1;
  if (cpu_seconds > 0) {
    const rlimit limit = {static_cast<rlim_t>(cpu_seconds), static_cast<rlim_t>(cpu_seconds)};
    prlimit(process, RLIMIT_CPU, &limit, nullptr);
  }
  return process;
}

}  // namespace

bool Finished::succeeded() const {
  return status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void run_processes(const Processes& how, const std::vector<std::size_t>& items,
                   const std::function<std::vector<std::string>(std::size_t)>& arguments,
                   const std::function<void(const Finished&)>& ended) {
  const auto progress = cli::progress_line(how.doing);
  std::map<pid_t, Finished> running;
  std::size_t next = 0;
  int done = 0;
  const auto finish = [&](Finished& of, int status) {
    of.status = status;
    ended(of);
    std::error_code code;
    fs::remove(of.out, code);
    fs::remove(of.err, code);
    ++done;
    if (!how.doing.empty()) progress(done, static_cast<int>(items.size()));
  };
  while (next < items.size() || !running.empty()) {
    while (next < items.size() && running.size() < static_cast<std::size_t>(how.at_once)) {
      const std::size_t n = items[next++];
      const std::string name = std::to_string(getpid()) + "." + std::to_string(n);
      Finished to{n, how.scratch / (name + ".out"), how.scratch / (name + ".err")};
      const pid_t process = start(arguments(n), to, how.cpu_seconds);
      if (process > 0)
        running[process] = to;
      else
        finish(to, -1);
    }
    if (running.empty()) continue;
    int status = 0;
    const auto of = running.find(waitpid(-1, &status, 0));
    if (of == running.end()) continue;  // interrupted
    finish(of->second, status);
    running.erase(of);
  }
}

std::string reason(const Finished& process, const std::string& who) {
  if (process.status == -1) return "no process could be started for it";
  if (WIFSIGNALED(process.status))
    return who + " was ended by signal " + std::to_string(WTERMSIG(process.status));
  const std::string err = whole_file(process.err);
  std::string line = err.substr(0, err.find('\n'));
  if (line.rfind("sinew: ", 0) == 0) line.erase(0, 7);
  return line.empty() ? who + " ended with code " + std::to_string(WEXITSTATUS(process.status)) : line;
}

std::string whole_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool has_ended(pid_t process) {
  return kill(process, 0) != 0 && errno == ESRCH;
}

void clear_leftovers(const fs::path& directory) {
  static const std::regex kHalf(R"((?:.*\.tmp(\d+))|(?:(\d+)\.\d+\.(?:out|err)))");
  std::error_code code;
  std::vector<fs::path> dead;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, code)) {
    std::smatch found;
    const std::string name = entry.path().filename().string();
    if (name.size() > 255 || !std::regex_match(name, found, kHalf)) continue;
    const long process = std::strtol(found[found[1].matched ? 1 : 2].str().c_str(), nullptr, 10);
    if (process > 0 && has_ended(static_cast<pid_t>(process))) dead.push_back(entry.path());
  }
  for (const fs::path& path : dead) fs::remove(path, code);
}

}  // namespace sinew::batch
