// Rigid transforms, templated on the scalar.
#pragma once

#include "sinew/skeleton/vector.h"

namespace sinew {

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
