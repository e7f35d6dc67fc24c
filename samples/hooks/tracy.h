// The runtime's zones in Tracy (https://github.com/wolfpld/tracy), beside a game's own. To be compiled where
// <tracy/TracyC.h> and TRACY_ENABLE are those of the client that the program is linked with; versions from
// 0.7.
//
//     if (!sinew::set_profiler(tracy_zones())) …  // a runtime without SINEW_PROFILER
#pragma once

#include <sinew/skeleton/hooks.h>
#include <tracy/TracyC.h>

#include <array>
#include <cstdint>
#include <cstring>

/// Zones that are open on a thread. They nest a handful deep; deeper ones are counted and not shown.
struct OpenTracyZones {
  std::array<TracyCZoneCtx, 32> zones{};
  std::size_t open = 0;

  static OpenTracyZones& of_this_thread() {
    thread_local OpenTracyZones mine;
    return mine;
  }
  void begin(const char* name) {
    if (open++ < zones.size())
      zones[open - 1] = ___tracy_emit_zone_begin_alloc(place_of(___tracy_alloc_srcloc_name, name), 1);
  }
  void end() {
    if (open > 0 && --open < zones.size()) ___tracy_emit_zone_end(zones[open]);
  }

 private:
  /// Tracy frees it. Since 0.11 a colour is asked for, too: 0 is the default one.
  template <class... Colour>
  static std::uint64_t place_of(std::uint64_t (*make)(std::uint32_t, const char*, std::size_t, const char*,
                                                      std::size_t, const char*, std::size_t, Colour...),
                                const char* name) {
    constexpr const char kSource[] = "sinew";
    return make(0, kSource, sizeof kSource - 1, name, std::strlen(name), name, std::strlen(name),
                Colour{}...);
  }
};

/// For sinew::set_profiler().
inline sinew::Profiler tracy_zones() {
  return {[](void*, const char* zone) { OpenTracyZones::of_this_thread().begin(zone); },
          [](void*, const char*) { OpenTracyZones::of_this_thread().end(); }, nullptr};
}
