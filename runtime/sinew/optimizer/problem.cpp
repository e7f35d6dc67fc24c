#include "sinew/optimizer/problem.h"

#include <algorithm>
#include <cmath>

#include "sinew/effects/gravity.h"
#include "sinew/optimizer/joint_terms.h"

namespace sinew {

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

namespace {

/// Of a symmetric matrix, by its leading minors.
template <class T>
bool positive_definite(const Mat3<T>& m) {
  const T second = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  return m(0, 0) > T(0) && second > T(0) && m.determinant() > T(0);
}

}  // namespace

template <class T>
double begin_evaluation(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  forward_kinematics<T>(tree, p.local, p.common_origin, p.kinematics);
  const T weight = p.prediction.weight;
  double energy = 0;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T>& c = p.kinematics.center[i];
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Vec3<T> off = c - p.prediction.center[i];
    const T mass = tree.mass[i];
    const Mat3<T> second = tree.second_moment[i];
    const Mat3<T> turned = r - p.prediction.rotation[i];
    energy += double(T(0.5) * weight * mass * off.squaredNorm()) +
              double(gravity_energy<T>(mass, settings.gravity, c));
    p.body_force[i] = (weight * mass) * off + gravity_gradient<T>(mass, settings.gravity);
    if (p.prediction.scheme == Scheme::kMomentum) {
      // No energy belongs to this; the solver judges by the directional derivative alone.
      const Vec3<T> turn = rotation_log<T>(Quat<T>(Mat3<T>(r * p.prediction.start[i].transpose())));
      const Mat3<T> inertia = r * tree.inertia[i] * r.transpose();
      p.couple[i] = (inertia * turn / settings.h - p.prediction.momentum[i]) / settings.h;
    } else {
      const Mat3<T> a = (weight * r) * second * p.prediction.rotation[i].transpose();
      energy += double(T(0.5) * weight * (turned * second).cwiseProduct(turned).sum());
      p.couple[i] = {a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1)};
    }
    p.force[i] = p.body_force[i];
    p.moment[i] = c.cross(p.force[i]) + p.couple[i];
  }
  for (const ExternalForce<T>& push : p.pushes)
    energy += add_gradient<T>(push, p.kinematics, {p.force, p.moment});
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
  project_wrenches<T>(*p.tree, p.kinematics, p.force, p.moment, p.gradient);
  for (const JointRow<T>& row : p.rows) {
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += slope * row.gradient[a];
  }
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
  const Tree<T>& tree = *p.tree;
  const T weight = p.prediction.weight;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Mat3<T> a = (weight * r) * tree.second_moment[i] * p.prediction.rotation[i].transpose();
    Mat3<T> stiffness = a.trace() * Mat3<T>::Identity() - T(0.5) * (a + a.transpose());
    // Far from the prediction the exact block may be indefinite; plain inertia then. Other clamps measured
    // equal.
    if (p.prediction.scheme == Scheme::kMomentum || !positive_definite(stiffness))
      stiffness = weight * (r * tree.inertia[i] * r.transpose());
    p.composite[i] = {};
    p.composite[i].add_body(weight * tree.mass[i], p.kinematics.center[i], stiffness);
    p.composite[i].add_force(p.kinematics.center[i], p.body_force[i]);
    p.composite[i].couple += p.couple[i];
  }
  for (const ExternalForce<T>& push : p.pushes) add_curvature<T>(push, p.kinematics, p.composite);
  if (p.effects.empty()) return;
  if (p.stiff) std::fill(p.stiffness.begin(), p.stiffness.end(), SpatialStiffness<T>{});
  p.stiff = false;
  for (const Effect<T>* effect : p.effects)
    effect->add_curvature(effect_pose(settings, p), {p.composite, p.stiffness, p.stiff});
}

SINEW_PROBLEM_INSTANCES(template, float)
SINEW_PROBLEM_INSTANCES(template, double)

}  // namespace sinew
