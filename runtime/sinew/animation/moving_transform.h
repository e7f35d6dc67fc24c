// Moving frames: rigid transforms whose numbers carry their derivatives, so that composing them is
// kinematics.
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
/// A moving frame, child → parent. Products and inverses give exact velocities and accelerations, Coriolis
/// terms included.
template <class T>
using MovingTransform = Transform<TimeJet<T>>;

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

/// Turns the direction of `from` into that of `to` the short way. Neither zero; not for opposite directions.
template <class T>
Quat<TimeJet<T>> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to);

/// A joint's jet as a moving frame child → parent.
template <class T>
MovingTransform<T> moving_transform(const JointJet<T>& jet);
/// And back; the rotation may have any length but 0.
template <class T>
JointJet<T> joint_jet(const MovingTransform<T>& moving);

/// Gives a jet the rotation of a moving quaternion, of any length. Its translation stays.
template <class T>
void set_rotation(const Quat<TimeJet<T>>& rotation, JointJet<T>& jet);

/// Frame of a joint in that of an ancestor, or in model space (the axes of the root's parent), by walking up.
/// `parents` [joint], −1 for a root.
template <class T>
MovingTransform<T> model_motion(std::span<const JointJet<T>> jets, std::span<const int> parents, int joint,
                                int ancestor = -1);

#define SINEW_MOVING_INSTANCES(prefix, T)                                                  \
  prefix Quat<TimeJet<T>> shortest_arc<T>(const MovingVector<T>&, const MovingVector<T>&); \
  prefix MovingTransform<T> moving_transform<T>(const JointJet<T>&);                       \
  prefix JointJet<T> joint_jet<T>(const MovingTransform<T>&);                              \
  prefix void set_rotation<T>(const Quat<TimeJet<T>>&, JointJet<T>&);                      \
  prefix MovingTransform<T> model_motion<T>(std::span<const JointJet<T>>, std::span<const int>, int, int);
SINEW_MOVING_INSTANCES(extern template, float)
SINEW_MOVING_INSTANCES(extern template, double)

}  // namespace sinew
