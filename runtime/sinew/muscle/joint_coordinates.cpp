#include "sinew/muscle/joint_coordinates.h"

namespace sinew {

template <class T>
std::array<T, 6> joint_offset_value(const Tree<T>& tree, int i, const Transform<T>& reference,
                                    const Transform<T>& local) {
  std::array<T, 6> value{};
  const Vec3<T> shift = local.translation - reference.translation;
  const auto turn = [&](const Vec3<T>& axis) {
    // Twists add on the right, so the angle from rest does not see what the reference does across the axis.
    const Quat<T> rest = tree.rest[i].rotation.conjugate();
    T angle = twist_angle<T>(rest * local.rotation, axis) - twist_angle<T>(rest * reference.rotation, axis);
    constexpr T pi = T(3.14159265358979323846);
    if (angle > pi) angle -= 2 * pi;
    if (angle < -pi) angle += 2 * pi;
    return angle;
  };
  switch (tree.type[i]) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      value[0] = turn(tree.axis[i]);
      break;
    case JointType::kPrismatic:
      value[0] = (local.rotation * tree.axis[i]).dot(shift);
      break;
    case JointType::kUniversal: {
      value[1] = turn(tree.axis2[i]);
      const auto without_second = [&](const Quat<T>& r) {
        const Quat<T> q = tree.rest[i].rotation.conjugate() * r;
        return Quat<T>(q * rotation_exp<T>(tree.axis2[i] * -twist_angle<T>(q, tree.axis2[i])));
      };
      value[0] = twist_angle<T>(without_second(local.rotation), tree.axis[i]) -
                 twist_angle<T>(without_second(reference.rotation), tree.axis[i]);
      break;
    }
    case JointType::kBall: {
      const Vec3<T> r = rotation_log<T>(reference.rotation.conjugate() * local.rotation);
      value = {r.x(), r.y(), r.z()};
      break;
    }
    case JointType::kPlanar: {
      const Vec3<T> a = tree.axis[i].unitOrthogonal(), b = tree.axis[i].cross(a);
      const Vec3<T> in_rest = tree.rest[i].rotation.conjugate() * shift;
      value = {a.dot(in_rest), b.dot(in_rest), turn(tree.axis[i])};
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

template <class T>
JointOffset<T> joint_offset(const Tree<T>& tree, int i, const Transform<T>& reference,
                            const Transform<T>& local) {
  JointOffset<T> offset;
  offset.value = joint_offset_value<T>(tree, i, reference, local);
  const std::array<T, 6>& value = offset.value;
  if (tree.type[i] == JointType::kBall)
    offset.rotational = right_jacobian_inverse<T>({value[0], value[1], value[2]});
  // A free joint's chart turns on the left, exp(d)·R = R·exp(Rᵀd).
  if (tree.type[i] == JointType::kFree)
    offset.rotational = right_jacobian_inverse<T>({value[3], value[4], value[5]}) *
                        local.rotation.conjugate().toRotationMatrix();
  return offset;
}

template <class T>
Transform<T> at_offset(const Tree<T>& tree, int i, const Transform<T>& reference,
                       const std::array<T, 6>& offset) {
  if (tree.type[i] != JointType::kFree) return displaced<T>(tree, i, reference, offset.data());
  Transform<T> moved = reference;
  moved.translation += Vec3<T>(offset[0], offset[1], offset[2]);
  moved.rotation = (reference.rotation * rotation_exp<T>({offset[3], offset[4], offset[5]})).normalized();
  return moved;
}

template <class T>
Transform<T> rebased(const Tree<T>& tree, int i, const Transform<T>& reference, const Transform<T>& local) {
  switch (tree.type[i]) {
    case JointType::kFixed:
      return reference;
    case JointType::kFree:
    case JointType::kTranslation:
      return local;
    case JointType::kBall:
      return {local.rotation, reference.translation};
    default:
      return at_offset<T>(tree, i, reference, joint_offset<T>(tree, i, reference, local).value);
  }
}

SINEW_COORDINATE_INSTANCES(template, float)
SINEW_COORDINATE_INSTANCES(template, double)

}  // namespace sinew
