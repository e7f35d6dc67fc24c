// The offsets of joint_coordinates.h on any scalar: float, double or a pack of characters of one rig
// (pack.h).
#pragma once

#include "sinew/muscle/joint_coordinates.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

/// See joint_offset_value.
template <class T>
std::array<T, 6> offset_value_of(const Tree<Number<T>>& tree, int i, const Transform<T>& reference,
                                 const Transform<T>& local) {
  std::array<T, 6> value{};
  const Quat<T> unrest = tree.rest[i].rotation.conjugate().template cast<T>();
  const Vec3<T> axis1 = tree.axis[i].template cast<T>(), axis2 = tree.axis2[i].template cast<T>();
  const Vec3<T> shift = local.translation - reference.translation;
  const auto turn = [&](const Vec3<T>& axis) {
    // Twists add on the right, so the angle from rest does not see what the reference does across the axis.
    return twist_between<T>(unrest * reference.rotation, unrest * local.rotation, axis);
  };
  switch (tree.type[i]) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      value[0] = turn(axis1);
      break;
    case JointType::kPrismatic:
      value[0] = (local.rotation * axis1).dot(shift);
      break;
    case JointType::kUniversal: {
      value[1] = turn(axis2);
      const auto without_second = [&](const Quat<T>& r) {
        const Quat<T> q = unrest * r;
        return Quat<T>(q * rotation_exp<T>(axis2 * -twist_angle<T>(q, axis2)));
      };
      value[0] = twist_angle<T>(without_second(local.rotation), axis1) -
                 twist_angle<T>(without_second(reference.rotation), axis1);
      break;
    }
    case JointType::kBall: {
      const Vec3<T> r = rotation_log<T>(reference.rotation.conjugate() * local.rotation);
      value = {r.x(), r.y(), r.z()};
      break;
    }
    case JointType::kPlanar: {
      Vec3<T> a, b;
      planar_axes<T>(tree.axis[i], a, b);
      const Vec3<T> in_rest = unrest * shift;
      value = {a.dot(in_rest), b.dot(in_rest), turn(axis1)};
      break;
    }
    case JointType::kFree: {
      const Vec3<T> r = rotation_log<T>(reference.rotation.conjugate() * local.rotation);
      value = {shift.x(), shift.y(), shift.z(), r.x(), r.y(), r.z()};
      break;
    }
    case JointType::kTranslation:
      value = {shift.x(), shift.y(), shift.z()};
      break;
  }
  return value;
}

/// See joint_offset.
template <class T>
JointOffset<T> offset_of(const Tree<Number<T>>& tree, int i, const Transform<T>& reference,
                         const Transform<T>& local) {
  JointOffset<T> offset;
  offset.value = offset_value_of<T>(tree, i, reference, local);
  const std::array<T, 6>& value = offset.value;
  if (tree.type[i] == JointType::kBall)
    offset.rotational = right_jacobian_inverse<T>({value[0], value[1], value[2]});
  // A free joint's chart turns on the left, exp(d)·R = R·exp(Rᵀd).
  if (tree.type[i] == JointType::kFree)
    offset.rotational = right_jacobian_inverse<T>({value[3], value[4], value[5]}) *
                        local.rotation.conjugate().toRotationMatrix();
  return offset;
}

}  // namespace sinew
