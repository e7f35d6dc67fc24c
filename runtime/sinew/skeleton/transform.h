// Rigid transforms, templated on the scalar.
#pragma once

#include "sinew/skeleton/vector.h"

namespace sinew {

/// Rigid transform child → parent: x_parent = rotation · x_child + translation (metres).
template <class T>
struct Transform {
  Quat<T> rotation = Quat<T>::Identity();  ///< unit
  Vec3<T> translation = Vec3<T>::Zero();   ///< m, in parent axes

  /// A point of the child (m), in the parent.
  Vec3<T> operator*(const Vec3<T>& point) const { return rotation * point + translation; }
  /// First `child`, then this.
  Transform operator*(const Transform& child) const {
    return {rotation * child.rotation, rotation * child.translation + translation};
  }
  /// Parent → child.
  Transform inverse() const {
    const Quat<T> inv = rotation.conjugate();
    return {inv, -(inv * translation)};
  }
  /// The same in another scalar.
  template <class U>
  Transform<U> cast() const {
    return {rotation.template cast<U>(), translation.template cast<U>()};
  }
  /// Every number is the same.
  bool operator==(const Transform&) const = default;
};

}  // namespace sinew
