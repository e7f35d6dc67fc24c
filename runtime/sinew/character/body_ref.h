// How a host is told which body of a world something is about: contacts, queries.
#pragma once

#include <cstdint>

namespace sinew {

enum class BodyKind : std::uint8_t {
  kGround,     ///< WorldSettings::ground
  kObstacle,   ///< World::add_obstacle(Collider)
  kShape,      ///< World::add_obstacle(StaticShape)
  kCharacter,  ///< World::add_character
  kProp,       ///< World::add_prop
  kParticles,  ///< World::add_particles
};

struct BodyRef {
  BodyKind kind = BodyKind::kGround;
  int index = 0;  ///< in the order in which those of its kind were added; 0 for the ground
  int joint = 0;  ///< the simulated joint of a character that carries the body, the node of particles; else 0

  bool operator==(const BodyRef&) const = default;
  bool is_static() const { return kind <= BodyKind::kShape; }
};

}  // namespace sinew
