// Handles of the C interface: numbers that name an object as long as it lives, and nothing afterwards.
//
// A number holds what it names, the slot of the asset, graph or world in a table, the serial number that the
// slot had when that was made, and, for what is in a world, its index there. A slot whose serial numbers are
// used up is not used again. Looking one up takes no lock; making and destroying do.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sinew::c {

enum class Kind : std::uint8_t {
  kNone,
  kAsset,
  kWorld,
  kCharacter,
  kProp,
  kLoop,
  kGraph,
  kEffect,
  kParticles,
  kSensor
};

constexpr std::size_t kMostInWorld = 1u << 20;  ///< of a kind, that handles can tell apart

/// Set-up: a handle of `object`, or 0 where 65535 live already.
std::uint64_t make_handle(Kind owner, void* object);
/// What `handle` names, or of what is in a world that world; null where it is no `kind` that lives.
void* find_object(std::uint64_t handle, Kind kind) noexcept;
/// From now on the handle, and those of what is in it, name nothing. Returns what it named, so that of two
/// threads which destroy something one gets it; null where it named nothing.
void* retire_handle(std::uint64_t handle, Kind owner);
/// Of a character, prop, loop, effect or body of particles in the world that `world` names.
std::uint64_t handle_in(std::uint64_t world, Kind kind, int index) noexcept;
/// Handle of the world that something is in.
std::uint64_t world_of(std::uint64_t handle) noexcept;
/// In its world, of what is in one.
int index_of(std::uint64_t handle) noexcept;
/// Why find_object found nothing.
const char* why_not(std::uint64_t handle, Kind kind) noexcept;

}  // namespace sinew::c
