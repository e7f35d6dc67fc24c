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
    const bool passive = p.law.torque_plus[dof] <= T(0) || p.law.torque_minus[dof] <= T(0);
    if (p.free[dof] && (passive || load[dof] >= T(kSaturated))) return true;
  }
  return false;
}

template <class T>
bool carried_by_integration(const TreeProblem<T>& p, std::span<const T> load, int body) {
  while (body >= 0 && !integrates(p, load, body)) body = p.tree->parent[body];
  return body >= 0;
}

/// How far a body turns in h seconds (rad, its axes) by an angular momentum.
template <class T>
Vec3<T> turn_of(const TreeProblem<T>& p, int i, const Vec3<T>& momentum, T h) {
  return h * (p.tree->inverse_inertia[i] * (p.kinematics.rotation[i].transpose() * momentum));
}

template <class T>
BossakWeights<T> weights_of(const TreeProblem<T>& p) {
  return BossakWeights<T>(p.prediction.rho > T(0) ? p.prediction.rho : T(1));
}

}  // namespace

template <class T>
void begin_error(const TreeProblem<T>& problem, const History<T>& history, T h,
                 const Vec3<double>& common_origin, const Strike<T>& strike, std::span<Vec3<T>> moved,
                 std::span<Vec3<T>> turned) {
  const Tree<T>& tree = *problem.tree;
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  const T ahead = problem.prediction.rho > T(0) ? h * (T(0.5) - weights_of(problem).kappa) : T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    moved[i] = problem.kinematics.center[i] - place - history.center[i] - h / 2 * history.velocity[i];
    if (!strike.velocity.empty()) moved[i] += h * strike.velocity[i];
    // The free turn, which is exact, is that of the predicted momentum.
    const Mat3<T> turn = problem.prediction.rotation[i].transpose() * problem.kinematics.rotation[i];
    const Vec3<T> predicted = history.momentum[i] + ahead * history.torque[i];
    turned[i] =
        rotation_log<T>(Quat<T>(turn)) - turn_of<T>(problem, i, history.momentum[i] / 2 - predicted, h);
  }
}

template <class T>
double integration_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load,
                         T h, std::span<const Vec3<T>> moved, std::span<const Vec3<T>> turned) {
  const Tree<T>& tree = *problem.tree;
  T sum = T(0), mass = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    if (!carried_by_integration(problem, load, i)) continue;
    const Vec3<T> left = moved[i] - h / 2 * history.velocity[i];
    const Vec3<T> twist = turned[i] - turn_of<T>(problem, i, history.momentum[i], h / 2);
    sum += tree.mass[i] * left.squaredNorm() + twist.dot(tree.inertia[i] * twist);
  }
  return mass > T(0) ? double(12 * (weights_of(problem).kappa - T(1) / 6) * std::sqrt(sum / mass)) : 0;
}

SINEW_ERROR_INSTANCES(template, float)
SINEW_ERROR_INSTANCES(template, double)

}  // namespace sinew
