// What problem.h computes per body, on any scalar: float, double or a pack of characters of one rig (pack.h).
//
// `p` is a TreeProblem<T> or what has its members. Packs know no other scheme than the runtime's.
#pragma once

#include <type_traits>

#include "sinew/effects/gravity.h"
#include "sinew/optimizer/problem.h"
#include "sinew/optimizer/time_scheme.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

/// Of a symmetric matrix, by its leading minors.
template <class T>
auto positive_definite(const Mat3<T>& m) {
  const T second = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  return both(both(m(0, 0) > T(0), second > T(0)), T(m.determinant()) > T(0));
}

/// Couple of A = α R P R̂ᵀ about a body's centre of mass, from (R − R̂) P: R̂ P R̂ᵀ is symmetric and has none,
/// and near the prediction what is left does not drown in its rounding.
template <class T>
Vec3<T> inertial_couple(const Mat3<T>& turned_second, const Mat3<T>& predicted, const T& weight) {
  const auto entry = [&](int i, int j) {
    return T(turned_second.row(i).dot(predicted.row(j)) - turned_second.row(j).dot(predicted.row(i)));
  };
  return weight * Vec3<T>(entry(2, 1), entry(0, 2), entry(1, 0));
}

/// What inertia asks for about a body's centre of mass, by its energy.
template <class T, class Problem>
Vec3<T> inertial_couple(const Problem& p, int i) {
  const Mat3<T>& predicted = p.prediction.rotation[i];
  const Mat3<T> turned = (p.kinematics.rotation[i] - predicted) * p.tree->second_moment[i].template cast<T>();
  return inertial_couple<T>(turned, predicted, p.prediction.weight);
}

/// Whether turning has no energy: see TimeScheme.
template <class Problem>
bool lacks_energy(const Problem& p) {
  if constexpr (requires { p.prediction.other; })
    return p.prediction.other && !p.prediction.other->has_energy();
  else
    return false;
}

/// Inertia's and gravity's part of begin_evaluation: energy (J, in double precision), wrenches.
template <class T, class Problem>
auto inertial_energy(const StepSettings<Number<T>>& settings, Problem& p) {
  const Tree<Number<T>>& tree = *p.tree;
  const Vec3<T> gravity = settings.gravity.template cast<T>();
  const T weight = p.prediction.weight;
  auto energy = widened(T(0));
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T>& c = p.kinematics.center[i];
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Vec3<T> off = c - p.prediction.center[i];
    const T mass = T(tree.mass[i]);
    energy +=
        widened(T(T(0.5) * weight * mass * off.squaredNorm())) + widened(gravity_energy<T>(mass, gravity, c));
    p.body_force[i] = (weight * mass) * off + gravity_gradient<T>(mass, gravity);
    if (lacks_energy(p)) {
      if constexpr (std::is_arithmetic_v<T>) p.couple[i] = p.prediction.other->couple(settings, p, i);
    } else {
      const Mat3<T> turned = r - p.prediction.rotation[i];
      const Mat3<T> second = turned.lazyProduct(tree.second_moment[i].template cast<T>());
      energy += widened(T(T(0.5) * weight * sum_of_products<T>(second, turned)));
      p.couple[i] = inertial_couple<T>(second, p.prediction.rotation[i], weight);
    }
    p.force[i] = p.body_force[i];
    p.moment[i] = c.cross(p.force[i]) + p.couple[i];
  }
  return energy;
}

/// Projection and the rows' part of finish_gradient.
template <class T, class Problem>
void project_gradient(Problem& p) {
  sum_and_project<T>(*p.tree, p.kinematics, std::span<Vec3<T>>(p.force), std::span<Vec3<T>>(p.moment),
                     std::span<T>(p.gradient));
  for (const JointRow<T>& row : p.rows) {
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += slope * row.gradient[a];
  }
}

/// Inertia's part of begin_composite.
template <class T, class Problem>
void inertial_composite(Problem& p) {
  const Tree<Number<T>>& tree = *p.tree;
  const T weight = p.prediction.weight;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    const Mat3<T> a =
        (weight * r) * tree.second_moment[i].template cast<T>() * p.prediction.rotation[i].transpose();
    Mat3<T> stiffness = a.trace() * Mat3<T>::Identity() - T(0.5) * (a + a.transpose());
    // Far from the prediction the exact block may be indefinite; plain inertia then. Other clamps measured
    // equal.
    const auto plain = [&] {
      return Mat3<T>(weight * (r * tree.inertia[i].template cast<T>() * r.transpose()));
    };
    if (lacks_energy(p))
      stiffness = plain();
    else
      stiffness = choose(
          positive_definite(stiffness), [&] { return stiffness; }, plain);
    p.composite[i] = Composite<T>();
    p.composite[i].add_body(weight * T(tree.mass[i]), p.kinematics.center[i], stiffness);
    p.composite[i].add_force(p.kinematics.center[i], p.body_force[i]);
    p.composite[i].couple += p.couple[i];
  }
}

}  // namespace sinew
