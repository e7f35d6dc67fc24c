#include "sinew/effects/joint_limit.h"

#include <cmath>
#include <limits>

namespace sinew {
namespace {

/// Of a limit that isn't there, or too far away to bear within a step.
template <class T>
constexpr T kFar = -std::numeric_limits<T>::infinity();

/// A row for each side that is less than infinitely far from being passed; `row` is of the upper one.
template <class T>
void append_sides(T stiffness, T above, T below, JointRow<T> row, std::vector<JointRow<T>>& rows) {
  row.kind = RowKind::kOneSided;
  row.stiffness = stiffness;
  if (above > kFar<T>) {
    row.value = above;
    rows.push_back(row);
  }
  if (below > kFar<T>) {
    row.value = below;
    row.sign = -row.sign;
    for (T& g : row.gradient) g = -g;
    rows.push_back(row);
  }
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
  const T q = from_rest_.value[k];
  append_sides<T>(joint.limit_stiffness, upper < most ? q - upper : kFar<T>,
                  lower > -most ? lower - q : kFar<T>, joint.row(from_rest_, RowScalar::kFromRest, k), rows);
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
    const T swing = std::atan2(sine, cosine);
    row.scalar = RowScalar::kSwing;
    set(across / sine);
    append_sides<T>(joint.limit_stiffness, swing - limit, kFar<T>, row, rows);
  }
  if (const T toward = T(1) + a.dot(b); toward > T(0.05)) {
    const T twist = twist_angle<T>(relative, a);
    row.scalar = RowScalar::kTwist;
    set((a + b) / toward);
    const T above = twist - law.twist_upper[i], below = law.twist_lower[i] - twist;
    append_sides<T>(joint.limit_stiffness, above > -near ? above : kFar<T>, below > -near ? below : kFar<T>,
                    row, rows);
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
