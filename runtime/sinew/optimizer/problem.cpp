#include "sinew/optimizer/problem.h"

#include <algorithm>
#include <cmath>

#include "sinew/optimizer/bossak.h"
#include "sinew/optimizer/joint_terms.h"
#include "sinew/optimizer/problem_pass.h"

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
  capacity = capacity_of(t, 0, 0, 0);
  this->rows.reserve(5 * t.dofs + 3 * t.bodies);  // muscle, friction, damping, two limits; a cone's
  this->ellipsoids.reserve(t.bodies);
}

template <class T>
void TreeProblem<T>::plan(Effect<T>& effect) {
  if (effect.instances() == 0) return;
  effects.push_back(&effect);
  stiffness.resize(tree->bodies);
  effect_rows.reserve(effect_rows.capacity() + effect.most_rows());
  this->rows.reserve(this->rows.capacity() + effect.most_rows());
}

template <class T>
void measure_effect_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  p.effect_rows.clear();
  for (const Effect<T>* effect : p.effects) effect->add_rows(effect_pose(settings, p), p.effect_rows);
  if (!settings.constant_muscles) return;
  const T emphasis = constant_emphasis(p.prediction.weight, settings.h);
  for (JointRow<T>& row : p.effect_rows)
    if (row.scalar == RowScalar::kFromStart) row.stiffness *= emphasis;  // as joint_damping.h
}

template <class T>
double begin_evaluation(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  forward_kinematics<T>(tree, p.local, p.common_origin, p.kinematics);
  double energy = inertial_energy<T>(settings, p);
  p.outside_energy = 0;
  const auto add = [&](double of_outside) {
    energy += of_outside;
    p.outside_energy += std::abs(of_outside);
  };
  for (const ExternalForce<T>& push : p.pushes)
    add(settings.plan->impulses->add_gradient(push, p.kinematics, {p.force, p.moment}));
  measure_joint_rows(settings, p);
  if (!p.effects.empty()) {
    for (const Effect<T>* effect : p.effects)
      add(effect->add_gradient(effect_pose(settings, p), {p.force, p.moment}));
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
  for (const ExternalForce<T>& push : p.pushes)
    settings.plan->impulses->add_curvature(push, p.kinematics, p.composite);
  if (p.effects.empty()) return;
  if (p.stiff) std::fill(p.stiffness.begin(), p.stiffness.end(), SpatialStiffness<T>{});
  p.stiff = false;
  for (const Effect<T>* effect : p.effects)
    effect->add_curvature(effect_pose(settings, p), {p.composite, p.stiffness, p.stiff});
}

SINEW_PROBLEM_INSTANCES(template, float)
SINEW_PROBLEM_INSTANCES(template, double)

}  // namespace sinew
