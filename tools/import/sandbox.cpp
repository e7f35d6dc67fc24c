#include "import/sandbox.h"

#include <fcntl.h>
#include <poll.h>
#include <seccomp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <new>

namespace sinew::import {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kConfine = false;
#else
constexpr bool kConfine = true;
#endif

void limit(__rlimit_resource what, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(what, &both);
}

bool lock_down() {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_KILL_PROCESS);
  if (!filter) return false;
  bool ok = true;
  for (const int call :
       {SCMP_SYS(read),          SCMP_SYS(pread64),      SCMP_SYS(write),        SCMP_SYS(close),
        SCMP_SYS(fstat),         SCMP_SYS(newfstatat),   SCMP_SYS(lseek),        SCMP_SYS(munmap),
        SCMP_SYS(mremap),        SCMP_SYS(brk),          SCMP_SYS(madvise),      SCMP_SYS(futex),
        SCMP_SYS(exit),          SCMP_SYS(exit_group),   SCMP_SYS(rt_sigreturn), SCMP_SYS(rt_sigprocmask),
        SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday), SCMP_SYS(getpid),       SCMP_SYS(gettid),
        SCMP_SYS(tgkill),        SCMP_SYS(getrandom),    SCMP_SYS(sysinfo)})
    ok = ok && seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) == 0;
  // Memory, but never code.
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect)})
    ok = ok &&
         seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 1, SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)) == 0;
  for (const int call : {SCMP_SYS(open), SCMP_SYS(openat), SCMP_SYS(stat), SCMP_SYS(access),
                         SCMP_SYS(readlink), SCMP_SYS(ioctl)})
    ok = ok && seccomp_rule_add(filter, SCMP_ACT_ERRNO(EACCES), call, 0) == 0;
  ok = ok && seccomp_load(filter) == 0;
  seccomp_release(filter);
  return ok;
}

void send(int pipe, char kind, const std::string& text) {
  const auto put = [&](const char* data, std::size_t size) {
    while (size > 0) {
      const ssize_t n = ::write(pipe, data, size);
      if (n <= 0) return;
      data += n;
      size -= static_cast<std::size_t>(n);
    }
  };
  put(&kind, 1);
  put(text.data(), text.size());
}

[[noreturn]] void child(int pipe, const ReadLimits& limits, const std::function<std::string()>& work) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_seconds) + 1);
  const int quiet = ::open("/dev/null", O_WRONLY);
  if (quiet >= 0) {
    dup2(quiet, STDOUT_FILENO);
    dup2(quiet, STDERR_FILENO);
  }
  if (kConfine) {
    limit(RLIMIT_AS, limits.memory_bytes);
    if (!lock_down()) {
      send(pipe, 'E', "the reader's sandbox cannot be set up on this system");
      _exit(0);
    }
  }
  try {
    send(pipe, 'A', work());
  } catch (const std::bad_alloc&) {
    send(pipe, 'E', "it needs more memory than a reader may have");
  } catch (const std::exception& e) {
    send(pipe, 'E', e.what());
  } catch (...) {
    send(pipe, 'E', "the reader failed without a word");
  }
  _exit(0);
}

std::string death(int status) {
  if (!WIFSIGNALED(status)) return "the reader stopped without an answer";
  switch (WTERMSIG(status)) {
    case SIGXCPU:
    case SIGKILL:
      return "the reader took too much time";
    case SIGSYS:
      return "the reader tried something that it may not";
    case SIGSEGV:
    case SIGBUS:
      return "the reader crashed on it (too deeply nested, or damaged)";
    case SIGABRT:
      return "the reader gave up on it (out of memory, or damaged)";
    default:
      return std::string("the reader was stopped by signal ") + std::to_string(WTERMSIG(status));
  }
}

}  // namespace

bool run_sandboxed(const ReadLimits& limits, const std::function<std::string()>& work, std::string& answer,
                   std::string& error) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    error = "no pipe to a reader can be made";
    return false;
  }
  const pid_t pid = fork();
  if (pid < 0) {
    close(ends[0]);
    close(ends[1]);
    error = "no reader process can be started";
    return false;
  }
  if (pid == 0) {
    close(ends[0]);
    child(ends[1], limits, work);
  }
  close(ends[1]);
  std::string received;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(limits.wall_seconds);
  bool late = false, large = false;
  char buffer[65536];
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      late = true;
      break;
    }
    pollfd waiting{ends[0], POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(left.count())) < 0 && errno != EINTR) break;
    if (!waiting.revents) continue;
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n <= 0) break;
    received.append(buffer, static_cast<std::size_t>(n));
    if (received.size() > limits.memory_bytes) {
      large = true;
      break;
    }
  }
  close(ends[0]);
  if (late || large) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (late) {
    error = "the reader took too much time";
  } else if (large) {
    error = "it holds more than a reader may answer";
  } else if (received.empty() || WIFSIGNALED(status)) {
    error = death(status);
  } else if (received[0] == 'A') {
    answer = received.substr(1);
    return true;
  } else {
    error = received.substr(1);
  }
  return false;
}

}  // namespace sinew::import
