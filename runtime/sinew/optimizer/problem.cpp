#include "sinew/optimizer/problem.h"

#include <algorithm>
#include <cmath>

#include "sinew/optimizer/joint_terms.h"
#include "sinew/optimizer/problem_pass.h"

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
    ellipsoidal.push_back(joint.ellipsoidal_limit);
  }
}

template <class T>
T JointLaw<T>::load(const Tree<T>& tree, int body, int dof, std::span<const T> torque) const {
  const auto share = [&](int n) {
    const T most = limit(n, torque[n]);
    return most > T(0) && std::isfinite(most) ? std::abs(torque[n]) / most : T(0);
  };
  if (!ellipsoidal[body]) return share(dof);
  const int first = tree.first_dof[body];
  return Vec3<T>(share(first), share(first + 1), share(first + 2)).norm();
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
      composite(t.bodies),
      joint_curvature(t.bodies, Mat3<T>::Zero()) {
  pushes.reserve(64);
  room = room_of(t, 0, 0, 0);
  rows.reserve(6 * t.dofs + 3 * t.bodies);
  ellipsoids.reserve(t.bodies);
}

template <class T>
void TreeProblem<T>::plan(Effect<T>& effect) {
  if (effect.instances() == 0) return;
  effects.push_back(&effect);
  stiffness.resize(tree->bodies);
  effect_rows.reserve(effect_rows.capacity() + effect.most_rows());
  rows.reserve(rows.capacity() + effect.most_rows());
}

template <class T>
void measure_effect_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  p.effect_rows.clear();
  for (const Effect<T>* effect : p.effects) effect->add_rows(effect_pose(settings, p), p.effect_rows);
}

template <class T>
double begin_evaluation(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  forward_kinematics<T>(tree, p.local, p.common_origin, p.kinematics);
  double energy = inertial_energy<T>(settings, p);
  for (const ExternalForce<T>& push : p.pushes) {
    const Vec3<T> x = p.kinematics.origin[push.body] + p.kinematics.rotation[push.body] * push.local;
    energy -= double(push.force.dot(x));
    p.force[push.body] -= push.force;
    p.moment[push.body] -= x.cross(push.force);
  }
  measure_joint_rows(settings, p);
  if (!p.effects.empty()) {
    for (const Effect<T>* effect : p.effects)
      energy += effect->add_gradient(effect_pose(settings, p), {p.force, p.moment});
    measure_effect_rows(settings, p);
    for (const JointRow<T>& row : p.effect_rows)
      if (p.free[row.dof]) p.rows.push_back(row);
  }
  for (const JointRow<T>& row : p.rows) energy += double(row.energy(row.value));
  for (const EllipsoidRow<T>& row : p.ellipsoids) energy += double(row.energy(row.value));
  return energy;
}

template <class T>
void finish_gradient(TreeProblem<T>& p) {
  project_gradient<T>(p);
  for (const JointRow<T>& row : p.effect_rows) {
    if (p.free[row.dof]) continue;  // in `rows`
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += slope * row.gradient[a];
  }
  for (const EllipsoidRow<T>& row : p.ellipsoids) {
    const Vec3<T> torque = row.gradient.transpose() * row.slope(row.value);
    for (int a = 0; a < 3; ++a) p.gradient[row.dof + a] += torque[a];
  }
}

template <class T>
void begin_composite(const StepSettings<T>& settings, TreeProblem<T>& p) {
  inertial_composite<T>(p);
  for (const ExternalForce<T>& push : p.pushes) {
    const Vec3<T> x = p.kinematics.origin[push.body] + p.kinematics.rotation[push.body] * push.local;
    p.composite[push.body].add_force(x, -push.force);
  }
  if (p.effects.empty()) return;
  if (p.stiff) std::fill(p.stiffness.begin(), p.stiffness.end(), SpatialStiffness<T>{});
  p.stiff = false;
  for (const Effect<T>* effect : p.effects)
    effect->add_curvature(effect_pose(settings, p), {p.composite, p.stiffness, p.stiff});
}

SINEW_PROBLEM_INSTANCES(template, float)
SINEW_PROBLEM_INSTANCES(template, double)

}  // namespace sinew
