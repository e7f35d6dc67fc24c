// Corrections of a pose after sampling and blending: limbs that reach a target, bones that aim at one.
//
// Both are written on moving numbers: from the motion of the animation and of the target come exact
// velocities and accelerations of the corrected pose, so a torque check after them is as sound as before. A
// target that only has a position (rates left 0) makes q' and q'' those of a target at rest: then filter it
// to be C², or the check sees a motion that the pose does not make.
#pragma once

#include <span>

#include "sinew/animation/moving_transform.h"

namespace sinew {

/// The three joints of a limb in model space.
template <class T>
struct LimbMotion {
  MovingTransform<T> upper;   ///< joint → model, as the others: that next to the body
  MovingTransform<T> middle;  ///< that in between
  MovingTransform<T> end;     ///< that which comes to a target

  LimbMotion() = default;
  /// Of joints one below the other.
  LimbMotion(std::span<const JointJet<T>> jets, std::span<const int> parents, int upper_joint,
             int middle_joint, int end_joint)
      : upper(model_motion<T>(jets, parents, upper_joint)),
        middle(upper * model_motion<T>(jets, parents, middle_joint, upper_joint)),
        end(middle * model_motion<T>(jets, parents, end_joint, middle_joint)) {}
  /// The limb is carried along.
  void shift(const MovingVector<T>& by) {
    for (MovingTransform<T>* joint : {&upper, &middle, &end}) joint->translation += by;
  }
};

/// Turns two joints of a limb so that the end joint's origin comes to the target: hip and knee, shoulder and
/// elbow. Joints in between (twist bones) ride along. Allocates nothing. Model space: the axes of the root's
/// parent.
///
/// A limb that is asked for more than 1 − `softness` of its length slows down and ends at 0.9995 of it, C²: a
/// straight knee would have infinite velocity. Targets nearer than |l₁ − l₂| end there, with a kink in
/// velocity.
template <class T>
struct TwoBoneJob {
  std::span<const int> parents;                        ///< [joint]
  std::span<JointJet<T>> jets;                         ///< [joint] local; upper, middle and end are changed
  int upper = -1;                                      ///< joint: hip or shoulder
  int middle = -1;                                     ///< joint below it: knee or elbow
  int end = -1;                                        ///< joint below that: ankle or wrist
  MovingVector<T> target = still<T>(Vec3<T>::Zero());  ///< m, model space
  /// Model direction in which the middle joint points away from the line upper → target; zero: as the
  /// animation bends it, which must not be straight then.
  MovingVector<T> pole = still<T>(Vec3<T>::Zero());
  /// Axis about which the middle joint bends, in its own axes: stays normal to the limb's plane. Zero: the
  /// upper bone turns the short way, whatever that does to a hinge.
  Vec3<T> hinge = Vec3<T>::Zero();
  TimeJet<T> weight{T(1)};  ///< 0 = animation, 1 = target reached
  bool keep_end = true;     ///< the end joint keeps its orientation in model space (a foot stays flat)
  T softness = T(0.05);     ///< part of the limb's length, [0.001, 1)

  Status Validate() const;  ///< what Run() refuses of any pose; `Status::index`: joint at fault
  /// Refuses as well a target at the upper joint, a bone without length, and a limb that has no plane to bend
  /// in. On an error `jets` are left as they were.
  Status Run() const;
  /// The same where it is known what Validate() says and how the limb moves, and where the end joint is to
  /// lie: to this rotation in model space it turns, or, without one, it rides along.
  Status Run(const LimbMotion<T>& limb, const MovingRotation<T>* end_rotation) const;
};

/// Turns one joint so that an axis of it points to a target: a head, an eye, a weapon. Several joints of a
/// chain: one job each, from the root outwards, with weights that grow to 1.
template <class T>
struct AimJob {
  std::span<const int> parents;                        ///< [joint]
  std::span<JointJet<T>> jets;                         ///< [joint] local; `joint` is changed
  int joint = -1;                                      ///< that turns
  MovingVector<T> target = still<T>(Vec3<T>::Zero());  ///< m, model space; not at the joint's origin
  Vec3<T> axis = Vec3<T>::UnitX();                     ///< unit, joint axes
  TimeJet<T> weight{T(1)};                             ///< of the turn, in R⁴
  /// Largest turn away from the animation, rad, below π; beyond it the turn stays that large (velocity has a
  /// kink).
  T limit = T(1.4);

  Status Validate() const;  ///< what Run() refuses of any pose; `Status::index`: joint at fault
  /// Refuses as well a target at the joint, or straight behind it: the way round is open then. On an error
  /// `jets` are left as they were.
  Status Run() const;
};

extern template struct TwoBoneJob<float>;
extern template struct TwoBoneJob<double>;
extern template struct AimJob<float>;
extern template struct AimJob<double>;

}  // namespace sinew
