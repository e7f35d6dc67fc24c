// Feet on uneven and on moving ground: legs and pelvis that follow their feet.
#pragma once

#include <span>

#include "sinew/animation/foot_leg.h"
#include "sinew/animation/foot_lock.h"
#include "sinew/animation/inverse_kinematics.h"

namespace sinew {

/// Keeps feet where they bear, turns them as the ground leans, and lowers the pelvis until they reach it.
/// Contacts come from the clips, not from speeds. A foot that comes down is locked to the ground under it,
/// wherever that moves; its way there, and back to the animation when it leaves or when it is too far from
/// the animation or from the hip, is a quintic, so that nothing jumps: exact derivatives, C².
///
/// `level` is the ground that the animation walks on: 0 if the root is at its clip's height; where the game
/// lifts the root on a slope or a stair, the height by which it does, with its rates.
///
/// A locked foot counts as a supporting one. Run it last, before the check of torques. Allocates nothing.
template <class T>
struct FootPlacementJob {
  std::span<const int> parents;        ///< [joint]
  std::span<JointJet<T>> jets;         ///< [joint] local; pelvis and legs are changed
  int pelvis = 0;                      ///< joint that carries the legs
  std::span<const FootLeg<T>> legs;    ///< at most eight
  std::span<const FootInput<T>> feet;  ///< [leg]
  std::span<FootState<T>> states;      ///< [leg] the caller's
  /// The caller's, like `states`: the pelvis comes down as the legs need it, and rises no faster than this.
  /// Null: as fast as they let it, and a leg that leaves the ground nearly straight bends in a jerk. As all
  /// of SmoothInput, it takes what the legs need as constant during a step.
  SmoothInput<T>* drop = nullptr;
  std::span<const MovingTransform<T>> grounds = {};  ///< [GroundHit::ground] body → model; those that locks
                                                     ///< are on stay in their places
  TimeJet<T> level{T(0)};                            ///< m
  T step = 0;                                        ///< s since the last run
  FootSettings<T> settings = {};                     ///< of all feet
  T reach = T(0.995);  ///< of a leg's length, to which the pelvis comes down; in [0.5, 0.998]
  T follow = T(0.5);   ///< part of the feet's mean shift sideways that the pelvis takes, in [0, 1]
  T rise = T(0.07);    ///< s, half of the way up, > 0
  T deepest = T(0.3);  ///< m, that the pelvis comes down at most
  /// [leg] as `jets` move them, of who has cast rays from them; empty: they are worked out.
  std::span<const LimbMotion<T>> limbs = {};

  Status Validate() const;  ///< `Status::index`: leg at fault
  /// Places what it can: a leg that finds no plane to bend in keeps its pose, the others do not; the first
  /// such leg is the error. What Validate() refuses leaves all as it was.
  Status Run() const;
};

extern template struct FootPlacementJob<float>;
extern template struct FootPlacementJob<double>;

}  // namespace sinew
