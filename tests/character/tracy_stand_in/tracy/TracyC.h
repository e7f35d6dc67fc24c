// What of Tracy's C interface the sample's adapter calls, and a list of what it was told. Debian has no
// Tracy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct TracyCZoneCtx {
  std::uint32_t id;
  int active;
};

/// "begin name" and "end name".
inline std::vector<std::string> told;
inline std::vector<std::string> names{""};

#ifdef TRACY_ASKS_FOR_A_COLOUR
#define COLOUR , std::uint32_t colour
#else
#define COLOUR
#endif
// NOLINTBEGIN(bugprone-reserved-identifier): these are Tracy's
inline std::uint64_t ___tracy_alloc_srcloc_name(std::uint32_t, const char*, std::size_t, const char*,
                                                std::size_t, const char* name, std::size_t length COLOUR) {
#ifdef TRACY_ASKS_FOR_A_COLOUR
  if (colour != 0) return 0;
#endif
  names.emplace_back(name, length);
  return names.size() - 1;
}
#undef COLOUR
inline TracyCZoneCtx ___tracy_emit_zone_begin_alloc(std::uint64_t place, int active) {
  told.push_back("begin " + names[place]);
  return {static_cast<std::uint32_t>(place), active};
}
inline void ___tracy_emit_zone_end(TracyCZoneCtx zone) {
  told.push_back("end " + names[zone.id]);
}
// NOLINTEND(bugprone-reserved-identifier)
