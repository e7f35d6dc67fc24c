// Processes of this program, several at once.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sinew::batch {

/// A process that ran, and where it wrote to.
struct Finished {
  std::size_t item = 0;            ///< which of the items it was for
  std::filesystem::path out, err;  ///< its standard output and error: removed after ended() has returned
  int status = -1;                 ///< as of waitpid; −1: no process could be started
  bool succeeded() const;
};

struct Processes {
  int at_once = 1;
  std::filesystem::path scratch;  ///< a directory for what they say
  long cpu_seconds = 0;           ///< each is ended by SIGXCPU after so much processor time; 0: never
  std::string doing;              ///< the word of the progress line; "": none
};

/// Runs `sinew ARGUMENTS` once for each of `items`, `at_once` at a time, and says how far it is:
/// arguments(item) before the start, ended(…) after the end.
void run_processes(const Processes& how, const std::vector<std::size_t>& items,
                   const std::function<std::vector<std::string>(std::size_t)>& arguments,
                   const std::function<void(const Finished&)>& ended);

/// Why one failed, in one line. `who`: "the converter".
std::string reason(const Finished& process, const std::string& who);

std::string whole_file(const std::filesystem::path& path);

/// Whether a process of this machine has ended.
bool has_ended(pid_t process);

/// Removes half-written files of processes that were killed: NAME.tmpPID, PID.N.out, PID.N.err.
void clear_leftovers(const std::filesystem::path& directory);

}  // namespace sinew::batch
