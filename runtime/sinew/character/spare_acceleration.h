// What a character's muscles have left, as accelerations: how fast a transition may be.
#pragma once

#include <span>

#include "sinew/character/world.h"

namespace sinew {

/// `out` [joint]: by how much the muscles could turn each joint faster than they do now, rad/s²: the least of
/// (limit − |torque|) / inertia over its degrees of freedom, the inertia that of all that hangs on the joint
/// about its origin, at most (half of the trace). As inertial_duration() takes it. Joints
/// that no muscle moves, and those without a body, do not limit anything: 10⁶.
///
/// What is left of the motion of the last step. FadeTimer (fade_timer.h) asks about the motion gone to
/// instead, and confirms what follows from it. Torques are worked out where it was only played, see
/// Character::load(). Allocates nothing. Cost O(joints · depth).
template <class T>
void spare_acceleration(const Character<T>& character, std::span<T> out);

/// `out` [joint]: kg·m², the inertia that the above divides by, in the present pose; 0 of joints without a
/// body. Allocates nothing. Cost O(joints · depth).
template <class T>
void carried_inertia(const Character<T>& character, std::span<T> out);

/// @cond
extern template void carried_inertia<float>(const Character<float>&, std::span<float>);
extern template void carried_inertia<double>(const Character<double>&, std::span<double>);
extern template void spare_acceleration<float>(const Character<float>&, std::span<float>);
extern template void spare_acceleration<double>(const Character<double>&, std::span<double>);
/// @endcond

}  // namespace sinew
