// How a host is told which body of a world something is about: contacts, queries.
#pragma once

#include <cstdint>

namespace sinew {

/// Which setting or call put it into the world.
enum class BodyKind : std::uint8_t {
  kGround,     ///< WorldSettings::ground
  kObstacle,   ///< World::add_obstacle(Collider)
  kShape,      ///< World::add_obstacle(StaticShape)
  kCharacter,  ///< World::add_character
  kProp,       ///< World::add_prop
  kParticles,  ///< World::add_particles
};

/// Names a body of a world; an index never comes to mean another one.
struct BodyRef {
  BodyKind kind = BodyKind::kGround;  ///< which list `index` is of
  int index = 0;  ///< in the order in which those of its kind were added; 0 for the ground
  int joint = 0;  ///< the simulated joint of a character that carries the body, the node of particles; else 0

  /// Names the same body.
  bool operator==(const BodyRef&) const = default;
  /// Nothing that happens moves it: ground, obstacles, the host's shapes.
  bool is_static() const { return kind <= BodyKind::kShape; }
};

}  // namespace sinew
