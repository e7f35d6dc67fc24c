#include "sinew/optimizer/bossak.h"

#include <algorithm>
#include <limits>

#include "sinew/skeleton/fewer_digits.h"

namespace sinew {
namespace {

/// ρ of small turns and of large ones, and up to and from how many rad these are.
struct Radii {
  double small, large, small_turn, large_turn;
};
constexpr Radii kPassive = {0.92, 0.8, 0.1, 0.3}, kDriven = {0.8, 0.5, 0.3, 0.8};
constexpr double kMostFreeTurn = 2;  ///< rad; beyond, the target is affine

template <class T>
Vec3<T> spin_of(const Tree<T>& tree, int i, const Mat3<T>& rotation, const Vec3<T>& momentum) {
  return rotation * (tree.inverse_inertia[i] * (rotation.transpose() * momentum));
}

}  // namespace

template <class T>
T turn_of(const History<T>& history, int body, T h) {
  return h * std::sqrt(history.rotation_rate[body].squaredNorm() / 2);
}

template <class T>
T largest_turn(const Tree<T>& tree, const History<T>& history, T h) {
  T fastest = T(0);
  for (int i = 0; i < tree.bodies; ++i) fastest = std::max(fastest, history.rotation_rate[i].squaredNorm());
  return h * std::sqrt(fastest / 2);
}

template <class T>
T share_turning_faster(const Tree<T>& tree, const History<T>& history, T speed) {
  Vec3<T> momentum = Vec3<T>::Zero();
  T mass = T(0), all = T(0), faster = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    momentum += tree.mass[i] * history.velocity[i];
  }
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> spin = spin_of<T>(tree, i, history.rotation[i], history.momentum[i]);
    const T energy =
        tree.mass[i] * (history.velocity[i] - momentum / mass).squaredNorm() + spin.dot(history.momentum[i]);
    all += energy;
    if (spin.squaredNorm() > speed * speed) faster += energy;
  }
  return faster / std::max(all, std::numeric_limits<T>::min());
}

template <class T>
Mat3<T> rotation_rate_of(const Tree<T>& tree, int body, const Mat3<T>& rotation, const Vec3<T>& momentum) {
  const Vec3<T> spin = spin_of<T>(tree, body, rotation, momentum);
  Mat3<T> rate;
  for (int a = 0; a < 3; ++a) rate.col(a) = spin.cross(rotation.col(a));
  return rate;
}

template <class T>
T spectral_radius(T turn, bool driven) {
  const Radii radii = driven ? kDriven : kPassive;
  const T share =
      std::clamp((turn - T(radii.small_turn)) / T(radii.large_turn - radii.small_turn), T(0), T(1));
  return T(radii.small) + share * T(radii.large - radii.small);
}

template <class T>
void predict_bossak(const Tree<T>& tree, const History<T>& history, const Strike<T>& strike, T rho, T h,
                    const Vec3<double>& common_origin, Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  const BossakWeights<T> w(rho);
  const T ahead = h * (T(0.5) - w.kappa);
  out.other = nullptr;
  out.rho = rho;
  out.weight = 1 / (w.kappa * h * h);
  out.momentum_step = h * w.gamma / (1 - w.alpha_m);
  const T of_torque = h * ((1 - w.gamma) - w.gamma * w.alpha_m / (1 - w.alpha_m));
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r0 = history.rotation[i];
    out.center[i] = place + history.center[i] + h * (history.velocity[i] + ahead * history.acceleration[i]);
    out.momentum[i] = history.momentum[i] + of_torque * history.torque[i];
    Vec3<T> momentum = history.momentum[i] + ahead * history.torque[i];
    if (!strike.velocity.empty()) {
      out.center[i] -= h * strike.velocity[i];
      momentum -= strike.momentum[i];
    }
    const Vec3<T> spin = tree.inverse_inertia[i] * (r0.transpose() * momentum);
    if (h * spin.norm() < T(kMostFreeTurn))
      out.rotation[i] = free_rotation<T>(tree.inverse_inertia[i], r0, momentum, h);
    else
      out.rotation[i] = r0 + h * skew<T>(r0 * spin) * r0;
  }
}

template <class T>
void accelerate(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& at_rest,
                std::span<const Vec3<T>> torque, History<T>& history) {
  for (int i = 0; i < tree.bodies; ++i) {
    history.acceleration[i] = at_rest.weight * (kinematics.center[i] - at_rest.center[i]);
    history.torque[i] = torque[i];
  }
}

template <class T>
void advance_bossak(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
                    std::span<const Vec3<T>> torque, const Jumps<T>& jumps, T h,
                    const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  const bool second = prediction.rho > T(0);
  const BossakWeights<T> w(second ? prediction.rho : T(1));
  const T alpha = prediction.weight;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> c1 = kinematics.center[i] - kinematics.origin[0], c0 = history.center[i] - moved;
    const Mat3<T>& r = kinematics.rotation[i];
    Vec3<T> force = alpha * (kinematics.center[i] - prediction.center[i]), couple = torque[i];  // by mass
    const auto momentum_of = [&](const Vec3<T>& spin) {
      return Vec3<T>(r * (tree.inertia[i] * (r.transpose() * spin)));
    };
    if (!second) history.momentum[i] = prediction.momentum[i] + prediction.momentum_step * couple;
    if (!jumps.moved.empty()) {
      force -= alpha * jumps.moved[i];
      couple -= alpha * momentum_of(jumps.turned[i]);
    }
    if (second) history.momentum[i] = prediction.momentum[i] + prediction.momentum_step * couple;
    if (second) {
      const Vec3<T> a0 = history.acceleration[i];
      const Vec3<T> a1 = (force - w.alpha_m * a0) / (1 - w.alpha_m);
      history.velocity[i] += h * ((1 - w.gamma) * a0 + w.gamma * a1);
      const Vec3<T> t1 = (couple - w.alpha_m * history.torque[i]) / (1 - w.alpha_m);
      history.acceleration[i] = a1.unaryExpr(&rounded_off<kSixthOfDigits<T>, T>);
      history.torque[i] = t1.unaryExpr(&rounded_off<kSixthOfDigits<T>, T>);
    } else {
      history.velocity[i] = (c1 - c0) / h;
      history.acceleration[i] = force;
      history.torque[i] = couple;
    }
    history.center[i] = c1;
    history.rotation[i] = r;
  }
  history.step_before = h;
  history.accelerates = true;
}

SINEW_BOSSAK_INSTANCES(template, float)
SINEW_BOSSAK_INSTANCES(template, double)

}  // namespace sinew
