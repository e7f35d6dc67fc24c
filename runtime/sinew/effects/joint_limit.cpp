#include "sinew/effects/joint_limit.h"

#include <cmath>

namespace sinew {
namespace {

/// Rows of a scalar between two bounds; none for a bound that is not there. `at_start` tells the scalar when
/// the step began, and is asked only where the bound is near.
template <class T, class AtStart>
void append_bounds(const JointStep<T>& joint, T scalar, T lower, T upper, AtStart at_start, JointRow<T> row,
                   std::vector<JointRow<T>>& rows) {
  constexpr T near = T(0.05);  // rad or m
  row.kind = RowKind::kOneSided;
  row.stiffness = joint.limit_stiffness;
  const auto append = [&](T sign, T bound) {
    row.value = sign * (scalar - bound);
    row.damp(joint.limit_damping, joint.h, row.value > -near ? sign * (at_start() - bound) : T(0));
    rows.push_back(row);
  };
  if (upper < joint.law.kUnlimited) append(T(1), upper);
  if (lower <= -joint.law.kUnlimited) return;
  row.sign = -row.sign;
  for (T& g : row.gradient) g = -g;
  append(T(-1), lower);
}

}  // namespace

template <class T>
JointLimitRows<T>::JointLimitRows(const JointStep<T>& joint)
    : from_rest_(joint_offset<T>(joint.tree, joint.body, joint.tree.rest[joint.body], joint.local)) {}

template <class T>
void JointLimitRows<T>::append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const {
  const int dof = joint.first_dof() + k;
  const T lower = joint.law.lower[dof], upper = joint.law.upper[dof], most = joint.law.kUnlimited;
  if (!(lower > -most || upper < most)) return;
  const Transform<T>& rest = joint.tree.rest[joint.body];
  append_bounds<T>(
      joint, from_rest_.value[k], lower, upper,
      [&] { return joint_offset_value<T>(joint.tree, joint.body, rest, joint.start)[k]; },
      joint.row(from_rest_, RowScalar::kFromRest, k), rows);
}

template <class T>
void append_cone(const JointStep<T>& joint, std::vector<JointRow<T>>& rows) {
  const JointLaw<T>& law = joint.law;
  const int i = joint.body;
  const Quat<T> relative = joint.tree.rest[i].rotation.conjugate() * joint.local.rotation;
  const Vec3<T>& a = law.swing_axis[i];
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = across.norm(), cosine = a.dot(b);
  const auto start = [&] { return Quat<T>(joint.tree.rest[i].rotation.conjugate() * joint.start.rotation); };
  JointRow<T> row;
  row.dof = joint.first_dof();
  row.count = 3;
  const auto set = [&](const Vec3<T>& in_rest) {
    const Vec3<T> in_child = relative.conjugate() * in_rest;
    row.gradient = {in_child.x(), in_child.y(), in_child.z()};
  };
  // Rows well inside the range cannot become active within a step; leave them out.
  constexpr T near = T(0.5);
  const T limit = law.swing_limit[i];
  if (sine > T(1e-6) && limit - near < T(3.14159265) && cosine < std::cos(std::max(limit - near, T(0)))) {
    row.scalar = RowScalar::kSwing;
    set(across / sine);
    const auto swing_at_start = [&] {
      const Vec3<T> bone = start() * a;
      return std::atan2(a.cross(bone).norm(), a.dot(bone));
    };
    append_bounds<T>(joint, std::atan2(sine, cosine), -law.kUnlimited, limit, swing_at_start, row, rows);
  }
  if (const T toward = T(1) + a.dot(b); toward > T(0.05)) {
    const T twist = twist_angle<T>(relative, a);
    row.scalar = RowScalar::kTwist;
    set((a + b) / toward);
    const T lower = law.twist_lower[i], upper = law.twist_upper[i];
    append_bounds<T>(
        joint, twist, twist < lower + near ? lower : -law.kUnlimited,
        twist > upper - near ? upper : law.kUnlimited, [&] { return twist_angle<T>(start(), a); }, row, rows);
  }
}

template <class T>
Mat3<T> cone_curvature(const Quat<T>& relative, const Vec3<T>& a, T swing_slope, T twist_slope) {
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = std::max(across.norm(), T(1e-6)), cosine = a.dot(b);
  const Vec3<T> n = across / sine;
  const T toward = std::max(T(1) + cosine, T(0.05));
  const Mat3<T> swing = (cosine * (Mat3<T>::Identity() - n * n.transpose()) -
                         T(0.5) * (a * b.transpose() + b * a.transpose())) /
                        sine;
  const Vec3<T> sum = a + b;
  const Mat3<T> twist = T(0.5) * (sum * across.transpose() + across * sum.transpose()) / (toward * toward);
  const Mat3<T> turn = relative.toRotationMatrix();
  return turn.transpose() * (swing_slope * swing + twist_slope * twist) * turn;
}

SINEW_JOINT_LIMIT_INSTANCES(template, float)
SINEW_JOINT_LIMIT_INSTANCES(template, double)

}  // namespace sinew
