// What a character's root does on the ground, apart from what it does as part of the body.
#pragma once

#include "sinew/animation/moving_transform.h"

namespace sinew {

/// root = travel ∘ body, both with exact derivatives.
template <class T>
struct RootMotion {
  JointJet<T>
      travel;  ///< heading about Z and position on the ground (z = 0): what a game's own controller moves
  JointJet<T> body;  ///< sway, bob and lean; what is left in the clip
};

/// Splits a root jet by swing and twist about Z. The heading is undefined for a root turned upside down (its
/// rotation is half a turn about a level axis).
template <class T>
RootMotion<T> split_root(const JointJet<T>& root) {
  const MovingTransform<T> whole = moving_transform(root);
  const Quat<TimeJet<T>> q = moving_quaternion(whole.rotation);
  const TimeJet<T> zero{T(0)};
  MovingTransform<T> travel;
  travel.rotation = moving_rotation(Quat<TimeJet<T>>(q.w(), zero, zero, q.z()));
  travel.translation << whole.translation.x(), whole.translation.y(), zero;
  return {joint_jet(travel), joint_jet<T>(travel.inverse() * whole)};
}

/// From one travel to the next: rotate and shift the character by this between two frames. A looping clip
/// goes on by its root_step, so its seam needs no case of its own.
template <class T>
Transform<T> travel_between(const JointJet<T>& before, const JointJet<T>& after) {
  return Transform<T>{before.rotation, before.translation}.inverse() *
         Transform<T>{after.rotation, after.translation};
}

}  // namespace sinew
