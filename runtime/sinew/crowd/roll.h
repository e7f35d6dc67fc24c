// Who of a population plays what, and where he is, as flat bytes. Internal to the crowd layer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sinew/crowd/crowd.h"

namespace sinew {

/// One of a population. Bytes without gaps.
struct RollEntry {
  double time = 0, rate = 1, change = 0;   ///< see ClipTime
  float place[7] = {0, 0, 0, 1, 0, 0, 0};  ///< see CrowdTrack: rotation x y z w, m
  float strength = 1;                      ///< of all its muscles
  std::int32_t clip = -1;                  ///< of the caller's; -1: it plays nothing
  std::int32_t world = -1;                 ///< its place in the world, or -1
};
static_assert(sizeof(RollEntry) == 64);

/// All of a population but for its world.
struct Roll {
  std::vector<RollEntry> entries;   ///< [character]
  std::vector<std::int32_t> free;   ///< places of the world, the next one last
  std::int32_t turned_away = 0;     ///< see Population
  std::vector<std::uint8_t> taken;  ///< [place] read_roll()'s
};

/// Bytes of a roll of so many characters and places of the world.
std::size_t roll_bytes(std::size_t capacity, std::size_t places);
/// Writes as many into `out`, which has room for them.
void write_roll(const Roll& roll, std::size_t places, std::span<std::byte> out);
/// Refuses what is no roll of so many places and of as many characters as there are in `roll`, with clips of
/// which there are `clips`; `roll` has changed then. Allocates nothing within the room that it has.
Status read_roll(std::span<const std::byte> in, std::size_t places, std::size_t clips, Roll& roll);

}  // namespace sinew
