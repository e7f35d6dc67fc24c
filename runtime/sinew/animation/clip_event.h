// What happens at certain times of a clip: footsteps, sounds, windows in which a blow counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sinew {

/// The number of an event's name, as in asset files: its 32-bit FNV-1a hash. A game switches over
/// `event_name("step")` without looking anything up; names of one asset never share a number.
constexpr std::uint32_t event_name(std::string_view text) {
  std::uint32_t hash = 2166136261u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

/// Something at an instant of a clip (begin = end) or during a part of it. Times in seconds of the clip.
struct ClipEvent {
  float begin = 0;                         ///< s, ≥ 0
  float end = 0;                           ///< s, from begin to the clip's duration
  std::uint32_t name = 0;                  ///< the game's number, or event_name()
  bool always = false;                     ///< reported whatever the weight
  std::array<std::byte, 16> payload = {};  ///< the game's
};

}  // namespace sinew
