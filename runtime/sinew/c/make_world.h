// How worlds of the C interface come to be, with a crowd or without.
#pragma once

#include <memory>

#include "sinew/c/call.h"

namespace sinew::c {

template <>
inline constexpr std::uint32_t kFirstSize<sinew_character_settings> = 80;  // up to bake

/// What sinew_world_settings holds.
struct WorldMake {
  WorldSettings world;
  bool restitution = false, continuous_detection = false;  ///< declared, or not
};

/// Null: defaults.
sinew_status read_world_settings(const sinew_world_settings* from, WorldMake& to);
/// Null: defaults.
sinew_status read_character_settings(const sinew_character_settings* from, CharacterSettings& to);
/// Declares what was asked for and gives the world a handle.
sinew_status hand_out(std::unique_ptr<OwnedWorld> world, const WorldMake& settings, sinew_world* out);

}  // namespace sinew::c
