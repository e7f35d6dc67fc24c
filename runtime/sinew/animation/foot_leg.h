// The parts of a leg that stands: its joints and where its sole touches the ground.
#pragma once

#include <span>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// One leg. Set-up; FootPlacementJob refuses joints that are not there.
template <class T>
struct FootLeg {
  int upper = -1;                  ///< joint: thigh
  int middle = -1;                 ///< joint: shin
  int foot = -1;                   ///< joint: foot
  Vec3<T> toe = Vec3<T>::Zero();   ///< m, foot axes: the sole under the ball
  Vec3<T> heel = Vec3<T>::Zero();  ///< m, foot axes: the sole under the heel; = toe: a point foot
  /// Direction in the axes of the upper joint to which the middle one points away; zero: as the animation
  /// bends it, which must not be straight then.
  Vec3<T> bend = Vec3<T>::Zero();
  Vec3<T> hinge = Vec3<T>::Zero();  ///< see TwoBoneJob
};

/// Leg and sole of a foot found by its role (kFootL, kFootR): thigh and shin above it, toes below it, the
/// sole by the colliders of foot and toes at rest. Errors if a role is missing.
template <class T>
Status find_foot_leg(const Skeleton& skeleton, Role foot, FootLeg<T>& out);

/// The legs of kFootL and kFootR, and the nearest joint that carries both: FootPlacementJob::pelvis. Errors
/// as of find_foot_leg, or if there is no such joint.
template <class T>
Status find_foot_legs(const Skeleton& skeleton, std::span<FootLeg<T>, 2> out, int& pelvis);

/// Whether a joint rests on the ground at a time of a clip, by Clip::contacts. The contact weight of a blend
/// is the sum of its clips' weights where they rest.
bool in_contact(const Clip& clip, double time, int joint);

/// @cond
extern template Status find_foot_leg<float>(const Skeleton&, Role, FootLeg<float>&);
extern template Status find_foot_leg<double>(const Skeleton&, Role, FootLeg<double>&);
extern template Status find_foot_legs<float>(const Skeleton&, std::span<FootLeg<float>, 2>, int&);
extern template Status find_foot_legs<double>(const Skeleton&, std::span<FootLeg<double>, 2>, int&);
/// @endcond

}  // namespace sinew
