// What a host may hear of the runtime besides the answers of its calls: what a step could not do, assumptions
// that do not hold, and how long its parts take. Memory has no hook of its own in C++: all of it comes from
// operator new, which a program may replace (c/sinew.h has sinew_set_memory for libraries that are loaded).
//
// Set hooks before anything else runs, or between steps: they are read without a lock, by any thread of a
// step. What they call is called on the thread where it happens; it must not throw, nor call Sinew.
#pragma once

#include <cstdint>

#include "sinew/skeleton/status.h"

namespace sinew {

/// What a message says about the result.
enum class LogLevel : std::uint8_t {
  kInfo,     ///< the result is less exact than it should be
  kWarning,  ///< something was given up: a contact left out, a body stopped
  kError,    ///< a call was refused
};

/// Where words go. `words` live for ever; `index`: which character, prop or element they are about, -1 if
/// none.
struct LogSink {
  /// Null: words go nowhere.
  void (*write)(void* context, LogLevel level, const char* words, int index) = nullptr;
  void* context = nullptr;  ///< given to `write`
};

/// From now on; nowhere at first. Without one a step costs a comparison more.
void set_log(const LogSink& sink) noexcept;
/// Whether anybody listens.
bool logs() noexcept;
/// Gives the sink a message, if there is one.
void write_log(LogLevel level, const char* words, int index = -1) noexcept;

/// Who hears of an assumption that does not hold, with its text and place. Where `failed` returns, the
/// program goes on.
struct AssertSink {
  /// Null: as without a sink.
  void (*failed)(void* context, const char* condition, const char* file, int line) = nullptr;
  void* context = nullptr;  ///< given to `failed`
};

/// Without one, an assumption that fails is written to stderr and the program aborts. Refused (kUnsupported)
/// where the runtime was built without SINEW_ASSERTS.
Status set_assert(const AssertSink& sink) noexcept;
/// What SINEW_ASSERT calls: the sink's function, or stderr and abort().
void assertion_failed(const char* condition, const char* file, int line) noexcept;

/// Parts of a step begin and end, nested, each on one thread. `zone`: its name, which lives for ever.
struct Profiler {
  void (*begin)(void* context, const char* zone) = nullptr;  ///< a part begins
  void (*end)(void* context, const char* zone) = nullptr;    ///< the part that began last on its thread ends
  void* context = nullptr;                                   ///< given to both
};

/// Both functions or none. Refused (kUnsupported) where the runtime was built without SINEW_PROFILER.
Status set_profiler(const Profiler& profiler) noexcept;
/// What set_profiler() was given last; null functions before.
const Profiler& profiler() noexcept;

/// From its making to its end.
class ProfilerZone {
 public:
  /// `name` lives for ever.
  explicit ProfilerZone(const char* name) noexcept : name_(name) {
    if (const Profiler& p = profiler(); p.begin) p.begin(p.context, name_);
  }
  ~ProfilerZone() {
    if (const Profiler& p = profiler(); p.end) p.end(p.context, name_);
  }
  ProfilerZone(const ProfilerZone&) = delete;
  ProfilerZone& operator=(const ProfilerZone&) = delete;

 private:
  const char* name_;
};

}  // namespace sinew

// Both are for the runtime's own sources, and nothing at all where they are not asked for when it is built.
#ifdef SINEW_PROFILER
#define SINEW_ZONE(name) const ::sinew::ProfilerZone sinew_zone(name)
#else
#define SINEW_ZONE(name) static_cast<void>(0)
#endif
#ifdef SINEW_ASSERTS
#define SINEW_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::sinew::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define SINEW_ASSERT(condition) static_cast<void>(0)
#endif
