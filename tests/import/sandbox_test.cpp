// What runs in the sandbox can compute and answer, nothing else. Each test plays a reader that was taken
// over.
#include "import/sandbox.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "reading.h"

namespace sinew::import::test {
namespace {

struct Result {
  bool ok = false;
  std::string answer, error;
};

Result run(
    const Work& work, const ReadLimits& limits = {},
    const OpenFile& broker = [](const std::string&) { return -1; }) {
  Result result;
  result.ok = run_sandboxed(limits, broker, work, result.answer, result.error);
  return result;
}

std::string outcome_of(long returned) {
  return returned < 0 ? std::strerror(errno) : "succeeded";
}

TEST(Sandbox, BringsTheAnswerBack) {
  std::string large(10 << 20, 'x');
  const Result result = run([&](const OpenFile&) { return large; });
  EXPECT_TRUE(result.ok) << result.error;
  EXPECT_EQ(result.answer, large);
}

TEST(Sandbox, BringsTheMessageOfAnExceptionBack) {
  const Result result = run([](const OpenFile&) -> std::string { throw std::runtime_error("third leg"); });
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "third leg");
}

struct Attempt {
  const char* name;
  long (*act)();
};

void PrintTo(const Attempt& attempt, std::ostream* out) {
  *out << attempt.name;
}

class Forbidden : public testing::TestWithParam<Attempt> {};

TEST_P(Forbidden, EndsTheReader) {
  if (!kConfined) GTEST_SKIP() << "the call filter is off under the address sanitizer";
  const Result result = run([](const OpenFile&) { return outcome_of(GetParam().act()); });
  EXPECT_FALSE(result.ok) << GetParam().name << " " << result.answer;
  EXPECT_EQ(result.error, "the reader tried something that it may not");
}

INSTANTIATE_TEST_SUITE_P(
    Calls, Forbidden,
    testing::Values(
        Attempt{"Socket", [] { return long(socket(AF_INET, SOCK_STREAM, 0)); }},
        Attempt{"Execve", [] { return long(execl("/bin/true", "true", nullptr)); }},
        Attempt{"Fork", [] { return long(fork()); }},
        Attempt{"SignalToTheParent", [] { return syscall(SYS_tgkill, getppid(), getppid(), SIGTERM); }},
        Attempt{"Kill", [] { return long(kill(getppid(), SIGTERM)); }},
        Attempt{"Unlink", [] { return long(unlink("/tmp/no such file")); }},
        Attempt{"Rename", [] { return long(rename("/tmp/no such file", "/tmp/nor this")); }},
        Attempt{"OpenByNewCall", [] { return syscall(SYS_openat2, AT_FDCWD, "/etc/passwd", nullptr, 0); }},
        Attempt{"MemoryWithCode",
                [] {
                  void* code = mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
                  return code == MAP_FAILED ? -1L : 0L;
                }}),
    [](const auto& one) { return one.param.name; });

TEST(Sandbox, OpensNothing) {
  if (!kConfined) GTEST_SKIP() << "the call filter is off under the address sanitizer";
  const Result result = run([](const OpenFile&) { return outcome_of(::open("/etc/passwd", O_RDONLY)); });
  EXPECT_TRUE(result.ok) << result.error;
  EXPECT_EQ(result.answer, std::strerror(EACCES));
}

TEST(Sandbox, InheritsNoDescriptor) {
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const int beyond = fcntl(pipe_ends[1], F_DUPFD, 32);  // a number that the child does not use itself
  const Result result = run([&](const OpenFile&) {
    struct stat info {};
    int open_ones = 0;
    for (int d = 0; d < 64; ++d) open_ones += fstat(d, &info) == 0;
    return std::to_string(open_ones) + " open, " + outcome_of(::write(beyond, "x", 1));
  });
  close(pipe_ends[0]);
  close(pipe_ends[1]);
  close(beyond);
  EXPECT_TRUE(result.ok) << result.error;
  // The standard streams (on /dev/null), the answer and the broker.
  EXPECT_EQ(result.answer, std::string("5 open, ") + std::strerror(EBADF));
}

TEST(Sandbox, EndsWorkThatTakesTooMuchMemory) {
  if (!kConfined) GTEST_SKIP() << "the memory limit is off under the address sanitizer";
  ReadLimits limits;
  limits.memory_bytes = 256u << 20;
  const Result result =
      run([](const OpenFile&) { return std::string(std::size_t(1) << 30, 'x').substr(0, 1); }, limits);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "the reader ran out of memory");
}

// The volatile sum after the call keeps the compiler from making a loop of it.
int descend(int depth) {
  volatile char frame[4096];
  frame[0] = static_cast<char>(depth);
  return depth == 0 ? 0 : descend(depth - 1) + frame[0];
}

TEST(Sandbox, SaysWhenTheStackRanOver) {
  const Result result = run([](const OpenFile&) { return std::to_string(descend(1 << 20)); });
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "it is nested too deeply (the reader ran out of stack)");
}

TEST(Sandbox, SaysWhenTheReaderCrashed) {
  const Result result = run([](const OpenFile&) -> std::string {
    raise(SIGSEGV);
    return "survived";
  });
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "the reader crashed on it: the file is damaged");
}

void work_forever() {
  const volatile bool on = true;
  while (on) {
  }
}

TEST(Sandbox, EndsWorkByTheClockOnTheWall) {
  ReadLimits limits;
  limits.wall_seconds = 0.2;
  const Result result = run(
      [](const OpenFile&) {
        work_forever();
        return std::string();
      },
      limits);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "the reader ran out of time");
}

TEST(Sandbox, EndsWorkByProcessorTime) {
  ReadLimits limits;
  limits.cpu_seconds = 0;  // one second is the least that the system can limit to
  limits.wall_seconds = 3600;
  const Result result = run(
      [](const OpenFile&) {
        work_forever();
        return std::string();
      },
      limits);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "the reader ran out of time");
}

TEST(Sandbox, EndsAReaderThatClosesItsPipeAndGoesOn) {
  ReadLimits limits;
  limits.cpu_seconds = limits.wall_seconds = 3600;
  const Result result = run(
      [](const OpenFile&) {
        for (int d = 3; d < 16; ++d) close(d);
        work_forever();
        return std::string();
      },
      limits);
  EXPECT_FALSE(result.ok);  // at once: else the test itself runs out of time
}

TEST(Sandbox, CutsAnAnswerThatIsTooLarge) {
  ReadLimits limits;
  limits.memory_bytes = 256u << 20;
  const Result result = run(
      [](const OpenFile&) -> std::string {
        const std::string block(1 << 20, 'x');
        for (;;)
          for (int d = 3; d < 16; ++d)  // its end of the answer pipe is among them
            if (::write(d, block.data(), block.size()) < 0 && errno == EPIPE) return "";
      },
      limits);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.error, "it holds more than a reader may answer");
}

TEST(Sandbox, PassesDescriptorsThatTheBrokerGrants) {
  const Scratch scratch;
  const auto file = scratch.write("granted", "content");
  const auto broker = [&](const std::string& name) {
    return name == "granted" ? ::open(file.c_str(), O_RDONLY | O_CLOEXEC) : -1;
  };
  const Result result = run(
      [](const OpenFile& open_file) {
        char text[16] = {};
        const ssize_t n = ::read(open_file("granted"), text, sizeof text);
        return std::string(text, n > 0 ? static_cast<std::size_t>(n) : 0) + ", " +
               std::to_string(open_file("something else"));
      },
      {}, broker);
  EXPECT_TRUE(result.ok) << result.error;
  EXPECT_EQ(result.answer, "content, -1");
}

}  // namespace
}  // namespace sinew::import::test
