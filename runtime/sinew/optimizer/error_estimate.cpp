#include "sinew/optimizer/error_estimate.h"

#include <cmath>

#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

constexpr double kSaturated =
    0.99;  ///< of the limit: from here on a muscle does not decide where its joint goes

/// Whether the joint of a body moves by integration: an unknown that no muscle holds on its target.
template <class T>
bool integrates(const TreeProblem<T>& p, std::span<const T> load, int body) {
  for (int dof = p.tree->first_dof[body]; dof < p.tree->first_dof[body + 1]; ++dof) {
    const bool limp = p.law.torque_plus[dof] <= T(0) || p.law.torque_minus[dof] <= T(0);
    if (p.free[dof] && (limp || load[dof] >= T(kSaturated))) return true;
  }
  return false;
}

template <class T>
bool carried_by_integration(const TreeProblem<T>& p, std::span<const T> load, int body) {
  while (body >= 0 && !integrates(p, load, body)) body = p.tree->parent[body];
  return body >= 0;
}

}  // namespace

template <class T>
double integration_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load,
                         T h) {
  const Prediction<T>& p = problem.prediction;
  if (p.other) return 0;
  const Tree<T>& tree = *problem.tree;
  const bool second = p.rho > T(0);  // else implicit Euler's: h/2 of the change of speed
  const BossakWeights<T> w(second ? p.rho : T(1));
  const T known = second ? T(1) : T(0), factor = second ? w.kappa - T(1) / 6 : T(0.5);
  T sum = T(0), mass = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    if (!carried_by_integration(problem, load, i)) continue;
    const Vec3<T> force = p.weight * (problem.kinematics.center[i] - p.center[i]);
    const Vec3<T> change = (force - known * history.acceleration[i]) / (1 - w.alpha_m);
    const Vec3<T> twist = problem.kinematics.rotation[i].transpose() *
                          Vec3<T>(problem.couple[i] - known * history.torque[i]) / (1 - w.alpha_m);
    sum += tree.mass[i] * change.squaredNorm() + twist.dot(tree.inverse_inertia[i] * twist);
  }
  return mass > T(0) ? double(factor * h * h * std::sqrt(sum / mass)) : 0;
}

template double integration_error<float>(const TreeProblem<float>&, const History<float>&,
                                         std::span<const float>, float);
template double integration_error<double>(const TreeProblem<double>&, const History<double>&,
                                          std::span<const double>, double);

}  // namespace sinew
