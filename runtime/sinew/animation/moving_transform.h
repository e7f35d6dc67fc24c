// Moving frames: rigid transforms that know how they move, so that composing them is kinematics.
#pragma once

#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/time_jet.h"

/// @cond
/// Vectors and quaternions of TimeJets are Eigen's.
template <class S>
struct Eigen::NumTraits<sinew::TimeJet<S>> : Eigen::GenericNumTraits<sinew::TimeJet<S>> {
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 3,
    AddCost = 3,
    MulCost = 9
  };
};
/// @endcond

namespace sinew {

/// A vector with its first two time derivatives, component by component.
template <class T>
using MovingVector = Vec3<TimeJet<T>>;

/// A vector that stays as it is.
template <class T>
MovingVector<T> still(const Vec3<T>& v) {
  return {v.x(), v.y(), v.z()};
}
/// Where it is.
template <class T>
Vec3<T> value_of(const MovingVector<T>& v) {
  return {v.x().value, v.y().value, v.z().value};
}
/// Its first time derivative.
template <class T>
Vec3<T> rate_of(const MovingVector<T>& v) {
  return {v.x().rate, v.y().rate, v.z().rate};
}
/// Its second time derivative.
template <class T>
Vec3<T> acceleration_of(const MovingVector<T>& v) {
  return {v.x().acceleration, v.y().acceleration, v.z().acceleration};
}

/// A rotation that moves, child → parent, as a JointJet has it: a quaternion's own derivatives would say the
/// same with more numbers, and each product of two would cost three times as much.
template <class T>
struct MovingRotation {
  Quat<T> value = Quat<T>::Identity();  ///< unit, child axes → parent axes
  Vec3<T> omega = Vec3<T>::Zero();      ///< rad/s, child axes
  Vec3<T> alpha = Vec3<T>::Zero();      ///< rad/s², child axes

  /// First `child`, then this.
  MovingRotation operator*(const MovingRotation& child) const;
  /// A vector of the child, in the parent.
  MovingVector<T> operator*(const MovingVector<T>& v) const;
  /// One that stays as it is in the child.
  MovingVector<T> operator*(const Vec3<T>& v) const;
  /// Parent → child.
  MovingRotation conjugate() const;
};

/// A moving frame, child → parent. Products and inverses give exact velocities and accelerations, Coriolis
/// terms included.
template <class T>
struct MovingTransform {
  MovingRotation<T> rotation = {};                          ///< child axes → parent axes
  MovingVector<T> translation = still<T>(Vec3<T>::Zero());  ///< m, in parent axes

  /// A point of the child (m), in the parent.
  MovingVector<T> operator*(const MovingVector<T>& point) const { return rotation * point + translation; }
  /// One that is fixed to the child.
  MovingVector<T> operator*(const Vec3<T>& point) const { return rotation * point + translation; }
  /// First `child`, then this.
  MovingTransform operator*(const MovingTransform& child) const {
    return {rotation * child.rotation, rotation * child.translation + translation};
  }
  /// Parent → child.
  MovingTransform inverse() const {
    const MovingRotation<T> back = rotation.conjugate();
    return {back, -(back * translation)};
  }
};

/// The rotation of a quaternion of any length but 0.
template <class T>
MovingRotation<T> moving_rotation(const Quat<TimeJet<T>>& q);
/// And back, of length 1.
template <class T>
Quat<TimeJet<T>> moving_quaternion(const MovingRotation<T>& rotation);

/// Turns the direction of `from` into that of `to` the short way. Neither zero; not for opposite directions.
template <class T>
MovingRotation<T> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to);
/// `part` of that turn, in R⁴: 0 = none, 1 = all of it.
template <class T>
MovingRotation<T> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to,
                               const TimeJet<T>& part);

/// A joint's jet as a moving frame child → parent.
template <class T>
MovingTransform<T> moving_transform(const JointJet<T>& jet);
/// And back.
template <class T>
JointJet<T> joint_jet(const MovingTransform<T>& moving);

/// A joint's jet without its translation.
template <class T>
MovingRotation<T> moving_rotation(const JointJet<T>& jet) {
  return {jet.rotation, jet.omega, jet.alpha};
}
/// And back. The jet's translation stays.
template <class T>
void set_rotation(const MovingRotation<T>& rotation, JointJet<T>& jet);

/// Frame of a joint in that of an ancestor, or in model space (the axes of the root's parent), by walking up.
/// `parents` [joint], −1 for a root.
template <class T>
MovingTransform<T> model_motion(std::span<const JointJet<T>> jets, std::span<const int> parents, int joint,
                                int ancestor = -1);

#define SINEW_MOVING_INSTANCES(prefix, T)                                                   \
  prefix struct MovingRotation<T>;                                                          \
  prefix MovingRotation<T> moving_rotation<T>(const Quat<TimeJet<T>>&);                     \
  prefix Quat<TimeJet<T>> moving_quaternion<T>(const MovingRotation<T>&);                   \
  prefix MovingRotation<T> shortest_arc<T>(const MovingVector<T>&, const MovingVector<T>&); \
  prefix MovingRotation<T> shortest_arc<T>(const MovingVector<T>&, const MovingVector<T>&,  \
                                           const TimeJet<T>&);                              \
  prefix MovingTransform<T> moving_transform<T>(const JointJet<T>&);                        \
  prefix JointJet<T> joint_jet<T>(const MovingTransform<T>&);                               \
  prefix void set_rotation<T>(const MovingRotation<T>&, JointJet<T>&);                      \
  prefix MovingTransform<T> model_motion<T>(std::span<const JointJet<T>>, std::span<const int>, int, int);
SINEW_MOVING_INSTANCES(extern template, float)
SINEW_MOVING_INSTANCES(extern template, double)

}  // namespace sinew
