// Rotations and rigid transforms, templated on the scalar.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sinew {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
template <class T>
using Quat = Eigen::Quaternion<T>;

/// Rigid transform child → parent: x_parent = rotation · x_child + translation (metres).
template <class T>
struct Transform {
  Quat<T> rotation = Quat<T>::Identity();
  Vec3<T> translation = Vec3<T>::Zero();

  Vec3<T> operator*(const Vec3<T>& point) const { return rotation * point + translation; }
  Transform operator*(const Transform& child) const {
    return {rotation * child.rotation, rotation * child.translation + translation};
  }
  Transform inverse() const {
    const Quat<T> inv = rotation.conjugate();
    return {inv, -(inv * translation)};
  }
  template <class U>
  Transform<U> cast() const {
    return {rotation.template cast<U>(), translation.template cast<U>()};
  }
  bool operator==(const Transform&) const = default;
};

}  // namespace sinew
