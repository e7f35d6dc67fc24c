#include "sinew/skeleton/hooks.h"

#include <cstdio>
#include <cstdlib>

namespace sinew {
namespace {

constinit LogSink log_sink;
constinit AssertSink assert_sink;
constinit Profiler listening;

#ifdef SINEW_ASSERTS
constexpr bool kAsserts = true;
#else
constexpr bool kAsserts = false;
#endif
#ifdef SINEW_PROFILER
constexpr bool kZones = true;
#else
constexpr bool kZones = false;
#endif

}  // namespace

void set_log(const LogSink& sink) noexcept {
  log_sink = sink;
}

bool logs() noexcept {
  return log_sink.write != nullptr;
}

void write_log(LogLevel level, const char* words, int index) noexcept {
  if (logs()) log_sink.write(log_sink.context, level, words, index);
}

Status set_assert(const AssertSink& sink) noexcept {
  if (!kAsserts) return Status::error(Code::kUnsupported, "built without SINEW_ASSERTS");
  assert_sink = sink;
  return {};
}

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  if (assert_sink.failed) return assert_sink.failed(assert_sink.context, condition, file, line);
  std::fprintf(stderr, "sinew: %s:%d: %s does not hold\n", file, line, condition);
  std::abort();
}

Status set_profiler(const Profiler& profiler) noexcept {
  if (!kZones) return Status::error(Code::kUnsupported, "built without SINEW_PROFILER");
  if ((profiler.begin != nullptr) != (profiler.end != nullptr))
    return Status::error(Code::kInvalidArgument, "a profiler needs both functions, or none");
  listening = profiler;
  return {};
}

const Profiler& profiler() noexcept {
  return listening;
}

}  // namespace sinew
