#include "import/sandbox.h"

#include <fcntl.h>
#include <poll.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <exception>
#include <new>
#include <string_view>

#include "import/broker.h"

namespace sinew::import {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kConfine = false;
#else
constexpr bool kConfine = true;
#endif

constexpr rlim_t kStackBytes = 16u << 20;  ///< twice the usual; the readers' recursion is bounded before
constexpr const char* kOutOfMemory = "the reader ran out of memory";
constexpr const char* kOutOfTime = "the reader ran out of time";

int answer_to = -1;  ///< the child's end of the answer pipe, for its fault handler

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
        SCMP_SYS(getrandom),     SCMP_SYS(sysinfo),      SCMP_SYS(recvmsg)})
    ok = ok && seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) == 0;
  // Memory, but never code; signals (abort) and datagrams (the broker's socket is connected) to nobody else.
  const auto self = static_cast<scmp_datum_t>(getpid());
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect)})
    ok = ok &&
         seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 1, SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)) == 0;
  ok =
      ok && seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, SCMP_A0(SCMP_CMP_EQ, self, 0)) == 0;
  ok = ok && seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(sendto), 1, SCMP_A4(SCMP_CMP_EQ, 0, 0)) == 0;
  for (const int call : {SCMP_SYS(open), SCMP_SYS(openat), SCMP_SYS(stat), SCMP_SYS(access),
                         SCMP_SYS(readlink), SCMP_SYS(ioctl)})
    ok = ok && seccomp_rule_add(filter, SCMP_ACT_ERRNO(EACCES), call, 0) == 0;
  ok = ok && seccomp_load(filter) == 0;
  seccomp_release(filter);
  return ok;
}

void send_answer(char kind, const char* text, std::size_t size) {
  const auto put = [](const char* data, std::size_t left) {
    while (left > 0) {
      const ssize_t n = ::write(answer_to, data, left);
      if (n <= 0) return;
      data += n;
      left -= static_cast<std::size_t>(n);
    }
  };
  put(&kind, 1);
  put(text, size);
}

void send_answer(char kind, const std::string& text) {
  send_answer(kind, text.data(), text.size());
}

/// Tells a stack that ran over from other faults: the address lies about where the stack pointer is.
void on_fault(int, siginfo_t* info, void* context) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  bool stack = false;
#if defined(__x86_64__)
  const auto* state = static_cast<const ucontext_t*>(context);
  const auto pointer = static_cast<std::uintptr_t>(state->uc_mcontext.gregs[REG_RSP]);
  constexpr std::uintptr_t kFrame = 1u << 16;
  stack = address < pointer + kFrame && pointer < address + kFrame;
#endif
  const std::string_view text = stack ? "it is nested too deeply (the reader ran out of stack)"
                                      : "the reader crashed on it: the file is damaged";
  send_answer('E', text.data(), text.size());
  _exit(0);
}

void catch_faults() {
  static char stack[1 << 16];  // not on the one that ran over
  stack_t alternative{};
  alternative.ss_sp = stack;
  alternative.ss_size = sizeof stack;
  sigaltstack(&alternative, nullptr);
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESETHAND;
  sigaction(SIGSEGV, &action, nullptr);
  sigaction(SIGBUS, &action, nullptr);
}

/// Closes every descriptor but two, and puts /dev/null in the place of standard input and outputs.
void keep_only(int& one, int& other) {
  one = fcntl(one, F_DUPFD_CLOEXEC, 3);
  other = fcntl(other, F_DUPFD_CLOEXEC, 3);
  const unsigned low = static_cast<unsigned>(std::min(one, other));
  const unsigned high = static_cast<unsigned>(std::max(one, other));
  if (low > 3) close_range(3, low - 1, 0);
  if (high > low + 1) close_range(low + 1, high - 1, 0);
  close_range(high + 1, ~0u, 0);
  for (int standard = 0; standard < 3; ++standard) close(standard);
  for (int standard = 0; standard < 3; ++standard)
    if (::open("/dev/null", O_RDWR) != standard) _exit(1);
}

[[noreturn]] void child(int answers, int requests, const ReadLimits& limits, const Work& work) {
  keep_only(answers, requests);
  answer_to = answers;
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_STACK, kStackBytes);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_seconds) + 1);
  catch_faults();
  if (kConfine) {
    limit(RLIMIT_AS, limits.memory_bytes);
    if (!lock_down()) {
      send_answer('E', "the reader's sandbox cannot be set up on this system");
      _exit(0);
    }
  }
  try {
    send_answer('A', work([requests](const std::string& name) { return request_file(requests, name); }));
  } catch (const std::bad_alloc&) {
    send_answer('E', kOutOfMemory);
  } catch (const std::exception& e) {
    send_answer('E', e.what());
  } catch (...) {
    send_answer('E', "the reader failed without a word");
  }
  _exit(0);
}

std::string death(int status) {
  if (!WIFSIGNALED(status)) return "the reader stopped without an answer";
  switch (WTERMSIG(status)) {
    case SIGXCPU:
    case SIGKILL:
      return kOutOfTime;
    case SIGSYS:
      return "the reader tried something that it may not";
    case SIGSEGV:
    case SIGBUS:
      return "the reader crashed on it: the file is damaged";
    case SIGABRT:
      return "the reader gave up on it (out of memory, or damaged)";
    default:
      return std::string("the reader was stopped by signal ") + std::to_string(WTERMSIG(status));
  }
}

/// What came over the answer pipe until it closed, serving requests for files meanwhile. Sets `error` and
/// stops early when time is up or the answer too large.
std::string collect(int answers, int requests, const ReadLimits& limits, const OpenFile& broker,
                    std::string& error) {
  std::string received;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(limits.wall_seconds);
  char buffer[65536];
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      error = kOutOfTime;
      return {};
    }
    pollfd waiting[2] = {{answers, POLLIN, 0}, {requests, POLLIN, 0}};
    if (poll(waiting, 2, static_cast<int>(left.count())) < 0) {
      if (errno == EINTR) continue;
      return received;
    }
    if (waiting[1].revents && !serve_request(requests, broker)) requests = -1;  // poll passes over it
    if (!waiting[0].revents) continue;
    const ssize_t n = read(answers, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return received;
    received.append(buffer, static_cast<std::size_t>(n));
    if (received.size() > limits.memory_bytes) {
      error = "it holds more than a reader may answer";
      return {};
    }
  }
}

}  // namespace

bool run_sandboxed(const ReadLimits& limits, const OpenFile& broker, const Work& work, std::string& answer,
                   std::string& error) {
  int answers[2], requests[2];
  if (pipe2(answers, O_CLOEXEC) != 0) {
    error = "no pipe to a reader can be made";
    return false;
  }
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, requests) != 0) {
    close(answers[0]);
    close(answers[1]);
    error = "no pipe to a reader can be made";
    return false;
  }
  const pid_t pid = fork();
  if (pid == 0) child(answers[1], requests[1], limits, work);
  close(answers[1]);
  close(requests[1]);
  std::string received;
  std::string stopped = pid < 0 ? "no reader process can be started" : "";
  if (pid > 0) received = collect(answers[0], requests[0], limits, broker, stopped);
  close(answers[0]);
  close(requests[0]);
  int status = 0;
  if (pid > 0) {
    kill(pid, SIGKILL);  // it has nothing more to say; no effect on one that already ends
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
  }
  if (!stopped.empty()) {
    error = stopped;
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
