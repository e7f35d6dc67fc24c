// What a host gives and hears: memory of its own, words about what went wrong, and a profile of every step
// for chrome://tracing or ui.perfetto.dev. Where the program has Tracy's client (CMake: find_package(Tracy)),
// zones go there instead, as they happen: tracy.h.
// Usage: hooks ASSET.sinew [TRACE.json]. A profile takes a runtime that was built with -DSINEW_PROFILER=ON.
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>
#include <sinew/skeleton/hooks.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <new>

#ifdef TRACY_ENABLE
#include "tracy.h"
#endif

// Memory: the runtime takes all of it from operator new, so whoever replaces that provides it. Here it is
// counted.
namespace {

std::atomic<long> blocks{0};

void* take(std::size_t bytes, std::size_t alignment) {
  // aligned_alloc wants a multiple of the alignment.
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
  ++blocks;
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
  return take(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, std::size_t(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace {

/// Zones as they begin and end, on one thread. A host with more keeps one of these for each.
class Trace {
 public:
  Trace() { events_.reserve(100000); }  // a step takes no memory, nor does who listens to it

  sinew::Profiler profiler() {
    return {[](void* trace, const char* zone) { static_cast<Trace*>(trace)->add('B', zone); },
            [](void* trace, const char* zone) { static_cast<Trace*>(trace)->add('E', zone); }, this};
  }
  bool empty() const { return events_.empty(); }

  /// The format of chrome://tracing: times in µs.
  bool write(const char* path) const {
    std::FILE* const file = std::fopen(path, "w");
    if (!file) return false;
    std::fputs("[", file);
    for (std::size_t n = 0; n < events_.size(); ++n)
      std::fprintf(file, "%s{\"ph\":\"%c\",\"name\":\"%s\",\"ts\":%.3f,\"pid\":1,\"tid\":1}",
                   n ? ",\n" : "\n", events_[n].phase, events_[n].zone, events_[n].time);
    std::fputs("\n]\n", file);
    return std::fclose(file) == 0;
  }

 private:
  struct Event {
    char phase;
    const char* zone;
    double time;
  };

  void add(char phase, const char* zone) {
    const std::chrono::duration<double, std::micro> since = Clock::now() - start_;
    if (events_.size() < events_.capacity()) events_.push_back({phase, zone, since.count()});
  }

  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  std::vector<Event> events_;
};

#ifdef TRACY_ENABLE
constexpr bool kTracy = true;
sinew::Profiler zones_go_to(Trace&) {
  return tracy_zones();
}
#else
constexpr bool kTracy = false;
sinew::Profiler zones_go_to(Trace& trace) {
  return trace.profiler();
}
#endif

void print(void* /*context*/, sinew::LogLevel level, const char* words, int index) {
  constexpr const char* kLevels[] = {"info", "warning", "error"};
  std::fprintf(stderr, "sinew %s: %s (%d)\n", kLevels[int(level)], words, index);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: hooks ASSET.sinew [TRACE.json]\n");
    return 2;
  }
  const char* const path = argc > 2 ? argv[2] : "trace.json";
  Trace trace;
  sinew::set_log({print, nullptr});
  const sinew::Status profiled = sinew::set_profiler(zones_go_to(trace));

  sinew::Asset asset;
  sinew::Status status = sinew::load_asset(argv[1], asset);
  if (!status || asset.clips.empty()) {
    std::fprintf(stderr, "hooks: %s: %s\n", argv[1], status ? "the asset has no clip" : status.reason);
    return 1;
  }
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  if (!hero.valid()) {
    std::fprintf(stderr, "hooks: %s\n", status.reason);
    return 1;
  }
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  const int chest = std::max(0, asset.skeleton.find(sinew::Role::kChest));
  const long set_up = blocks;
  for (int frame = 0; frame < 120; ++frame) {
    status = sinew::SamplingJob<float>{&asset.clips[0], frame / 60.0, jets}.Run();
    if (status) status = hero.set_target(jets);
    if (status && frame == 0) status = hero.reset();
    if (status && frame == 30)
      status = hero.apply_impulse(chest, hero.model()[std::size_t(chest)].translation, {0, 90, 0});
    if (status) status = world.step(1 / 60.f);
    if (!status) {
      std::fprintf(stderr, "hooks: frame %d: %s\n", frame, status.reason);
      return 1;
    }
  }
  const long in_steps = blocks - set_up;
  std::printf("memory: %ld blocks to set up, %ld in 120 steps\n", set_up, in_steps);
  if (!profiled) {
    std::printf("no profile: %s\n", profiled.reason);
  } else if (kTracy) {
    std::printf("profile: in Tracy\n");
  } else if (trace.empty() || !trace.write(path)) {
    std::fprintf(stderr, "hooks: %s: nothing could be written\n", path);
    return 1;
  } else {
    std::printf("profile: %s\n", path);
  }
  return in_steps == 0 ? 0 : 1;
}
