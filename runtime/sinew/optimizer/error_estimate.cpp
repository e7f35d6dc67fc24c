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

template <class T>
double bossak_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load, T h) {
  const Tree<T>& tree = *problem.tree;
  const Prediction<T>& p = problem.prediction;
  const BossakWeights<T> w(p.rho);
  T sum = T(0), mass = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    if (!carried_by_integration(problem, load, i)) continue;
    const Vec3<T> force = p.weight * (problem.kinematics.center[i] - p.center[i]);
    const Vec3<T> change = (force - history.acceleration[i]) / (1 - w.alpha_m);
    const Mat3<T>& r = problem.kinematics.rotation[i];
    const Vec3<T> twist = r.transpose() * Vec3<T>(problem.couple[i] - history.torque[i]) / (1 - w.alpha_m);
    sum += tree.mass[i] * change.squaredNorm() + twist.dot(tree.inverse_inertia[i] * twist);
  }
  return mass > T(0) ? double((w.kappa - T(1) / 6) * h * h * std::sqrt(sum / mass)) : 0;
}

}  // namespace

template <class T>
double integration_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load,
                         T h, const Vec3<double>& common_origin) {
  if (problem.prediction.scheme == Scheme::kBossak) return bossak_error(problem, history, load, h);
  const Tree<T>& tree = *problem.tree;
  const bool second = problem.prediction.scheme == Scheme::kBdf2;
  const bool first = problem.prediction.first;
  const T w = second && !first ? h / history.step_before : T(0);
  const T k1 = problem.prediction.k1, k2 = problem.prediction.k2;
  const T factor = second ? problem.prediction.momentum_step / 3 : h / 2;
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  T sum = T(0), mass = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    if (!carried_by_integration(problem, load, i)) continue;
    const Vec3<T> moved = problem.kinematics.center[i] - place - history.center[i];
    const Vec3<T> before =
        first ? Vec3<T>(h * history.velocity[i]) : Vec3<T>(history.center[i] - history.center_before[i]);
    const Vec3<T> velocity = (k1 * moved - k2 * before) / h;
    Vec3<T> change = velocity - history.velocity[i];
    // Angular velocities in body axes, of the momenta that the scheme carries: a steady spin is no error.
    const auto spin = [&](const Mat3<T>& rotation, const Vec3<T>& momentum) {
      return Vec3<T>(tree.inverse_inertia[i] * (rotation.transpose() * momentum));
    };
    const Vec3<T> momentum =
        problem.prediction.momentum[i] + problem.prediction.momentum_step * problem.couple[i];
    const Vec3<T> now = spin(history.rotation[i], history.momentum[i]);
    Vec3<T> turning = spin(problem.kinematics.rotation[i], momentum) - now;
    if (first) {
      // The acceleration at the start, which the prediction holds, in place of the last change of speed.
      change -= 4 / h * (problem.prediction.center[i] - place - history.center[i] - before);
      const Vec3<T> pushed = 2 * (problem.prediction.momentum[i] - history.momentum[i]);
      const Vec3<T> gyration = now.cross(Vec3<T>(tree.inertia[i] * now));
      turning -= spin(history.rotation[i], pushed) - h * (tree.inverse_inertia[i] * gyration);
    } else if (second) {
      change -= w * (history.velocity[i] - history.velocity_before[i]);
      turning -= w * (now - spin(history.rotation_before[i], history.momentum_before[i]));
    }
    sum += tree.mass[i] * change.squaredNorm() + turning.dot(tree.inertia[i] * turning);
  }
  return mass > T(0) ? double(factor * std::sqrt(sum / mass)) : 0;
}

template double integration_error<float>(const TreeProblem<float>&, const History<float>&,
                                         std::span<const float>, float, const Vec3<double>&);
template double integration_error<double>(const TreeProblem<double>&, const History<double>&,
                                          std::span<const double>, double, const Vec3<double>&);

}  // namespace sinew
