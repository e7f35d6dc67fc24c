// What of a world may come upon somebody who is not in it. For layers that keep characters beside a world.
#pragma once

#include "sinew/character/world.h"

namespace sinew {

/// World.
struct MovingBall {
  Vec3<double> center = Vec3<double>::Zero();  ///< m
  double radius = 0;                           ///< m
};

/// Characters, props and bodies of particles that a world has, parked ones included.
template <class T>
int member_count(const World<T>& world);
/// m, from the root of one of the world's characters as far as it reaches, however its joints are turned.
template <class T>
double reach_of(const World<T>& world, int character);
/// Whether one of them moves by itself: it is awake, and a character that is not on its animation, or nothing
/// that has one. `out` then holds it through the next h seconds, but for a character's own speed.
template <class T>
bool moves_by_itself(const World<T>& world, int member, T h, MovingBall& out);

#define SINEW_MOVERS_INSTANCES(prefix, T)          \
  prefix int member_count<T>(const World<T>&);     \
  prefix double reach_of<T>(const World<T>&, int); \
  prefix bool moves_by_itself<T>(const World<T>&, int, T, MovingBall&);
SINEW_MOVERS_INSTANCES(extern template, float)
SINEW_MOVERS_INSTANCES(extern template, double)

}  // namespace sinew
