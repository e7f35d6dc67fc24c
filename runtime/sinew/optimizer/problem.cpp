#include "sinew/optimizer/problem.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sinew {

template <class T>
JointLaw<T>::JointLaw(const Tree<T>& tree, const Skeleton& skeleton) {
  for (int i = 0; i < tree.bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const DofLimits& dof = joint.dofs[k];
      torque_minus.push_back(T(dof.torque_minus));
      torque_plus.push_back(T(dof.torque_plus));
      dry_friction.push_back(joint.type == JointType::kFree ? T(0) : T(dof.dry_friction));
      damping.push_back(T(dof.damping));
      lower.push_back(T(dof.lower));
      upper.push_back(T(dof.upper));
    }
    swing_limit.push_back(joint.type == JointType::kBall ? T(joint.swing_limit) : T(-1));
    swing_axis.push_back(joint.swing_axis.cast<T>());
    twist_lower.push_back(T(joint.twist_lower));
    twist_upper.push_back(T(joint.twist_upper));
  }
}

template <class T>
TreeProblem<T>::TreeProblem(const Tree<T>& t, const Skeleton& skeleton)
    : tree(&t),
      law(t, skeleton),
      prediction(t.bodies),
      local(t.bodies),
      target(t.bodies),
      start(t.bodies),
      free(t.dofs, 0),
      kinematics(t),
      force(t.bodies),
      moment(t.bodies),
      body_force(t.bodies),
      couple(t.bodies),
      gradient(t.dofs),
      composite(t.bodies) {
  pushes.reserve(64);
  rows.reserve(6 * t.dofs + 3 * t.bodies);
}

namespace {

constexpr double kUnlimited = 1e9;

/// Where a ball or free joint's row of offsets depends on the joint's own three rotations.
template <class T>
void set_gradient(const JointOffset<T>& offset, int rotational_first, int k, int first_dof,
                  JointRow<T>& row) {
  if (rotational_first >= 0 && k >= rotational_first) {
    row.dof = first_dof + rotational_first;
    row.count = 3;
    for (int a = 0; a < 3; ++a) row.gradient[a] = offset.rotational(k - rotational_first, a);
  } else {
    row.dof = first_dof + k;
    row.count = 1;
    row.gradient[0] = T(1);
  }
}

template <class T>
void append_limit(T stiffness, T violation_of_upper, T violation_of_lower, JointRow<T> row,
                  std::vector<JointRow<T>>& rows) {
  row.kind = RowKind::kOneSided;
  row.stiffness = stiffness;
  if (violation_of_upper < T(1e8)) {
    row.value = violation_of_upper;
    rows.push_back(row);
  }
  if (violation_of_lower < T(1e8)) {
    row.value = violation_of_lower;
    for (T& g : row.gradient) g = -g;
    rows.push_back(row);
  }
}

/// Swing cone and twist range of a ball joint, about the bone direction a at rest. With b the direction now,
/// the swing angle changes by n·w, n = (a × b)/|a × b|, the twist by (a + b)·w/(1 + a·b); w in rest axes.
template <class T>
void append_cone(const TreeProblem<T>& p, int i, T stiffness, std::vector<JointRow<T>>& rows) {
  const Tree<T>& tree = *p.tree;
  const Quat<T> relative = tree.rest[i].rotation.conjugate() * p.local[i].rotation;
  const Vec3<T>& a = p.law.swing_axis[i];
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = across.norm();
  const T swing = std::atan2(sine, a.dot(b));
  JointRow<T> row;
  row.dof = tree.first_dof[i];
  row.count = 3;
  const auto set = [&](const Vec3<T>& in_rest) {
    const Vec3<T> in_child = relative.conjugate() * in_rest;
    row.gradient = {in_child.x(), in_child.y(), in_child.z()};
  };
  // Rows well inside the range cannot become active within a step; leave them out.
  constexpr T near = T(0.5);
  if (sine > T(1e-6) && swing > p.law.swing_limit[i] - near) {
    set(across / sine);
    append_limit<T>(stiffness, swing - p.law.swing_limit[i], T(kUnlimited), row, rows);
  }
  if (const T toward = T(1) + a.dot(b); toward > T(0.05)) {
    const T twist = twist_angle<T>(relative, a);
    set((a + b) / toward);
    const T above = twist - p.law.twist_upper[i], below = p.law.twist_lower[i] - twist;
    append_limit<T>(stiffness, above > -near ? above : T(kUnlimited), below > -near ? below : T(kUnlimited),
                    row, rows);
  }
}

template <class T>
void measure_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  p.rows.clear();
  for (int i = 0; i < tree.bodies; ++i) {
    const int first = tree.first_dof[i], count = tree.dof_count(i);
    if (count == 0 || !p.free[first]) continue;
    const int rotational = tree.type[i] == JointType::kBall ? 0 : (tree.type[i] == JointType::kFree ? 3 : -1);
    const JointOffset<T> from_target = joint_offset<T>(tree, i, p.target[i], p.local[i]);
    const JointOffset<T> from_start = joint_offset<T>(tree, i, p.start[i], p.local[i]);
    const bool boxed = tree.type[i] != JointType::kFree && p.law.swing_limit[i] < T(0);
    const JointOffset<T> from_rest =
        boxed ? joint_offset<T>(tree, i, tree.rest[i], p.local[i]) : JointOffset<T>{};
    for (int k = 0; k < count; ++k) {
      const int dof = first + k;
      JointRow<T> row;
      if (p.law.torque_minus[dof] > T(0) || p.law.torque_plus[dof] > T(0)) {
        set_gradient(from_target, rotational, k, first, row);
        row.value = from_target.value[k];
        row.minus = p.law.torque_minus[dof];
        row.plus = p.law.torque_plus[dof];
        row.width = settings.kink_width;
        row.muscle = true;
        p.rows.push_back(row);
        row.muscle = false;
      }
      if (p.law.dry_friction[dof] > T(0)) {
        set_gradient(from_start, rotational, k, first, row);
        row.value = from_start.value[k];
        row.minus = row.plus = p.law.dry_friction[dof];
        row.width = 10 * settings.kink_width;
        p.rows.push_back(row);
      }
      if (p.law.damping[dof] > T(0)) {
        set_gradient(from_start, rotational, k, first, row);
        row.kind = RowKind::kSpring;
        row.value = from_start.value[k];
        row.stiffness = p.law.damping[dof] / settings.h;
        p.rows.push_back(row);
      }
      if (boxed && (p.law.lower[dof] > T(-kUnlimited) || p.law.upper[dof] < T(kUnlimited))) {
        set_gradient(from_rest, rotational, k, first, row);
        const T q = from_rest.value[k];
        append_limit<T>(
            settings.limit_stiffness, p.law.upper[dof] < T(kUnlimited) ? q - p.law.upper[dof] : T(kUnlimited),
            p.law.lower[dof] > T(-kUnlimited) ? p.law.lower[dof] - q : T(kUnlimited), row, p.rows);
      }
    }
    if (p.law.swing_limit[i] >= T(0)) append_cone(p, i, settings.limit_stiffness, p.rows);
  }
}

}  // namespace

template <class T>
double begin_evaluation(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  forward_kinematics<T>(tree, p.local, settings.common_origin, p.kinematics);
  const T weight = p.prediction.weight;
  double energy = 0;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T>& c = p.kinematics.center[i];
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Vec3<T> off = c - p.prediction.center[i];
    const T mass = tree.mass[i];
    const Mat3<T> second = tree.second_moment[i];
    const Mat3<T> turned = r - p.prediction.rotation[i];
    const Mat3<T> a = (weight * r) * second * p.prediction.rotation[i].transpose();
    energy +=
        double(T(0.5) * weight * (mass * off.squaredNorm() + (turned * second).cwiseProduct(turned).sum())) -
        double(mass * settings.gravity.dot(c));
    p.body_force[i] = (weight * mass) * off - mass * settings.gravity;
    p.couple[i] = {a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)};
    p.force[i] = p.body_force[i];
    p.moment[i] = c.cross(p.force[i]) + p.couple[i];
  }
  for (const ExternalForce<T>& push : p.pushes) {
    const Vec3<T> x = p.kinematics.origin[push.body] + p.kinematics.rotation[push.body] * push.local;
    energy -= double(push.force.dot(x));
    p.force[push.body] -= push.force;
    p.moment[push.body] -= x.cross(push.force);
  }
  measure_rows(settings, p);
  for (const JointRow<T>& row : p.rows) energy += double(row.energy(row.value));
  return energy;
}

template <class T>
void finish_gradient(TreeProblem<T>& p) {
  project_wrenches<T>(*p.tree, p.kinematics, p.force, p.moment, p.gradient);
  for (const JointRow<T>& row : p.rows) {
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += slope * row.gradient[a];
  }
}

template <class T>
void begin_composite(TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  const T weight = p.prediction.weight;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Mat3<T> a = (weight * r) * tree.second_moment[i] * p.prediction.rotation[i].transpose();
    Mat3<T> stiffness = a.trace() * Mat3<T>::Identity() - T(0.5) * (a + a.transpose());
    // Far from the prediction the exact block may be indefinite; plain inertia then. Other clamps measured
    // equal.
    if (Eigen::LLT<Mat3<T>>(stiffness).info() != Eigen::Success)
      stiffness = weight * (r * tree.inertia[i] * r.transpose());
    p.composite[i] = {};
    p.composite[i].add_body(weight * tree.mass[i], p.kinematics.center[i], stiffness);
    p.composite[i].add_force(p.kinematics.center[i], p.body_force[i]);
    p.composite[i].couple += p.couple[i];
  }
  for (const ExternalForce<T>& push : p.pushes) {
    const Vec3<T> x = p.kinematics.origin[push.body] + p.kinematics.rotation[push.body] * push.local;
    p.composite[push.body].add_force(x, -push.force);
  }
}

SINEW_PROBLEM_INSTANCES(template, float)
SINEW_PROBLEM_INSTANCES(template, double)

}  // namespace sinew
