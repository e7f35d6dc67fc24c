// What a simulated character tells of itself, for graphs and games to decide by.
#pragma once

#include <span>

namespace sinew {

/// How a character stands, and what its muscles bear. `physics_values()` (character/physics_values.h)
/// measures it, `set_physics()` (graph/graph_physics.h) hands it to a graph.
template <class T>
struct PhysicsValues {
  T tilt = 0;     ///< rad, 0 … π: of the root's vertical axis at rest from the world's
  T face_up = 0;  ///< how far the root's front (X at rest) points up: 1 on the back, −1 on the belly
  T height = 1;   ///< of the root over the ground, as a part of its height at rest
  T load = 0;     ///< the greatest |torque| / limit of all muscles; 1: saturated
  /// m: root mean square, over all mass, of how far the bodies are from where the animation wants them.
  T off_animation = 0;
  T contacts = 0;       ///< contact points that press; 0 where the animation was only played
  T contact_force = 0;  ///< their normal forces, as parts of the character's weight on Earth; likewise
  std::span<const T> joint_load = {};  ///< [joint] the greatest load of its muscles; empty: not known
};

}  // namespace sinew
