#include "study/schemes/schemes.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sinew/optimizer/problem.h"
#include "study/schemes/forward_euler.h"
#include "study/schemes/semi_implicit.h"

namespace sinew::study {
namespace {

/// (m − skew(carried)·turned)⁻¹, column by column.
template <class T>
Mat3<T> inverse_jacobian(Mat3<T> m, const Vec3<T>& carried, const Mat3<T>& turned) {
  for (int a = 0; a < 3; ++a) m.col(a) -= carried.cross(turned.col(a));
  Mat3<T> normals;
  for (int a = 0; a < 3; ++a) normals.col(a) = m.col((a + 1) % 3).cross(m.col((a + 2) % 3));
  return normals.transpose() / m.col(0).dot(normals.col(0));
}

/// Rotation vector x over one step of a free body whose backward-difference momentum equation is
/// I (k₁x − k₂x₋)/h = exp(−x)·l, in body axes. False where Newton does not converge or the turn is too large
/// to trust. Fixed-point iteration fails from h|ω| = 0.5 on.
template <class T>
bool torque_free_rotation(const Mat3<T>& inertia, const Vec3<T>& l, const Vec3<T>& before, T k1, T k2, T h,
                          Vec3<T>& x) {
  const T scale = l.norm();
  if (scale <= T(0)) {
    x.setZero();
    return true;
  }
  Mat3<T> inverse = Mat3<T>::Zero();
  constexpr T kLeft = sizeof(T) == 4 ? T(1e-7) : T(1e-11);  // rad
  T last = std::numeric_limits<T>::infinity(), last_length = T(1);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vec3<T> carried = rotation_exp<T>(-x) * l;
    const Vec3<T> error = inertia * (k1 * x - k2 * before) / h - carried;
    // The Jacobian of the first iterate serves until it stops to pay.
    const T size = error.norm();
    if (iteration == 0 || size > T(0.2) * last)
      inverse = inverse_jacobian(Mat3<T>(inertia * (k1 / h)), carried, right_jacobian(x));
    last = size;
    Vec3<T> step = inverse * error;
    if (!step.allFinite()) return false;
    const T length = step.norm();
    if (length > T(0.7)) step *= T(0.7) / length;
    x -= step;
    // The first step leaves less than its square, the others shrink at their rate or faster.
    if (length * length < kLeft * last_length) return x.norm() < T(2);
    last_length = length;
  }
  return false;
}

/// What bdf2 keeps of the state before: a row of numbers per body, then the step.
template <class T>
struct Earlier {
  static constexpr int kNumbers = 18;
  Vec3<T> center, velocity, momentum;
  Mat3<T> rotation;

  static T step(const History<T>& history) {
    return history.other.empty() || !(history.step_before > T(0)) ? T(0) : history.other.back();
  }
  static Earlier of(const History<T>& history, int body) {
    const T* const at = history.other.data() + body * kNumbers;
    Earlier e;
    for (Vec3<T>* v : {&e.center, &e.velocity, &e.momentum})
      *v = Eigen::Map<const Vec3<T>>(at + 3 * (v == &e.velocity) + 6 * (v == &e.momentum));
    e.rotation = Eigen::Map<const Mat3<T>>(at + 9);
    return e;
  }
  void write(History<T>& history, int body) const {
    T* const at = history.other.data() + body * kNumbers;
    Eigen::Map<Vec3<T>>{at} = center;
    Eigen::Map<Vec3<T>>{at + 3} = velocity;
    Eigen::Map<Vec3<T>>{at + 6} = momentum;
    Eigen::Map<Mat3<T>>{at + 9} = rotation;
  }
};

}  // namespace

template <class T>
void Bdf1<T>::declare(StepPlan<T>& plan) {
  static const Bdf1 scheme;
  plan.scheme = &scheme;
}

template <class T>
void Bdf1<T>::predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
                      Prediction<T>& out) const {
  predict_euler<T>(tree, history, h, common_origin, out);
  out.other = this;
}

template <class T>
void Bdf1<T>::advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
                      std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
                      History<T>& history) const {
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> c1 = kinematics.center[i] - kinematics.origin[0], c0 = history.center[i] - moved;
    history.velocity[i] = (c1 - c0) / h;
    history.center[i] = c1;
    history.rotation_rate[i] = (kinematics.rotation[i] - history.rotation[i]) / h;
    history.rotation[i] = kinematics.rotation[i];
    history.momentum[i] = prediction.momentum[i] + prediction.momentum_step * torque[i];
  }
  history.step_before = h;
  history.accelerates = false;
  history.turns_as_differenced = true;
}

template <class T>
void Momentum<T>::declare(StepPlan<T>& plan) {
  static const Momentum scheme;
  plan.scheme = &scheme;
}

template <class T>
void Momentum<T>::predict(const Tree<T>& tree, const History<T>& history, T h,
                          const Vec3<double>& common_origin, Prediction<T>& out) const {
  Bdf1<T>::predict(tree, history, h, common_origin, out);
  for (int i = 0; i < tree.bodies; ++i) out.rotation[i] = history.rotation[i];  // where its turn begins
}

template <class T>
Vec3<T> Momentum<T>::couple(const StepSettings<T>& settings, const TreeProblem<T>& p, int i) const {
  const Mat3<T>& r = p.kinematics.rotation[i];
  const Vec3<T> turn = rotation_log<T>(Quat<T>(Mat3<T>(r * p.prediction.rotation[i].transpose())));
  const Mat3<T> inertia = r * p.tree->inertia[i] * r.transpose();
  return (inertia * turn / settings.h - p.prediction.momentum[i]) / settings.h;
}

template <class T>
void Bdf2<T>::declare(StepPlan<T>& plan) {
  static const Bdf2 scheme;
  plan.scheme = &scheme;
}

template <class T>
void Bdf2<T>::keep(const History<T>& before, T h, History<T>& now) {
  const int bodies = static_cast<int>(now.center.size());
  now.other.resize(static_cast<std::size_t>(bodies) * Earlier<T>::kNumbers + 1);
  const Vec3<T> moved = (now.place - before.place).template cast<T>();
  for (int i = 0; i < bodies; ++i)
    Earlier<T>{before.center[i] - moved, before.velocity[i], before.momentum[i], before.rotation[i]}.write(
        now, i);
  now.other.back() = now.step_before = h;
}

template <class T>
void Bdf2<T>::predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
                      Prediction<T>& out) const {
  const T before = Earlier<T>::step(history);
  predict_euler<T>(tree, history, h, common_origin, out);
  out.other = this;
  if (!(before > T(0))) return;
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  const T w = h / before;
  const T a0 = (1 + w) * (1 + w) / (1 + 2 * w);
  const T a1 = -w * w / (1 + 2 * w);
  const T beta = (1 + w) / (1 + 2 * w);
  const T k1 = (1 + 2 * w) / (1 + w), k2 = w * w / (1 + w);
  out.weight = T(1) / (beta * h * beta * h);
  out.momentum_step = beta * h;
  for (int i = 0; i < tree.bodies; ++i) {
    const Earlier<T> e = Earlier<T>::of(history, i);
    out.center[i] = a0 * (place + history.center[i]) + a1 * (place + e.center) +
                    beta * h * (a0 * history.velocity[i] + a1 * e.velocity);
    out.momentum[i] = a0 * history.momentum[i] + a1 * e.momentum;
    const Mat3<T>& r0 = history.rotation[i];
    const Vec3<T> turned = rotation_log<T>(Quat<T>(Mat3<T>(e.rotation.transpose() * r0)));
    Vec3<T> x = turned * w;
    if (torque_free_rotation<T>(tree.inertia[i], r0.transpose() * out.momentum[i], turned, k1, k2, h, x))
      out.rotation[i] = r0 * rotation_exp<T>(x).toRotationMatrix();
    else
      out.rotation[i] = r0 + (beta * h) * history.rotation_rate[i] + (a1 * (e.rotation - r0));
  }
}

template <class T>
void Bdf2<T>::advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
                      std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
                      History<T>& history) const {
  const T before = Earlier<T>::step(history), w = before > T(0) ? h / before : T(0);
  const T k1 = (1 + 2 * w) / (1 + w), k2 = w * w / (1 + w);  // 1 and 0 in the first step
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  history.other.resize(static_cast<std::size_t>(tree.bodies) * Earlier<T>::kNumbers + 1);
  for (int i = 0; i < tree.bodies; ++i) {
    const Earlier<T> now{history.center[i] - moved, history.velocity[i], history.momentum[i],
                         history.rotation[i]};
    Earlier<T> e = now;
    if (before > T(0)) {
      e = Earlier<T>::of(history, i);
      e.center -= moved;
    }
    const Vec3<T> c1 = kinematics.center[i] - kinematics.origin[0];
    const Mat3<T>& r1 = kinematics.rotation[i];
    history.velocity[i] = (k1 * (c1 - now.center) - k2 * (now.center - e.center)) / h;
    history.rotation_rate[i] = (k1 * (r1 - now.rotation) - k2 * (now.rotation - e.rotation)) / h;
    history.center[i] = c1;
    history.rotation[i] = r1;
    history.momentum[i] = prediction.momentum[i] + prediction.momentum_step * torque[i];
    now.write(history, i);
  }
  history.other.back() = h;
  history.step_before = h;
  history.accelerates = false;
}

std::optional<Compared> scheme_named(const std::string& name) {
  static constexpr std::array<std::pair<const char*, Compared>, 6> kNames{
      {{"bossak", Compared::kBossak},
       {"bdf2", Compared::kBdf2},
       {"bdf1", Compared::kBdf1},
       {"momentum", Compared::kMomentum},
       {"semi_implicit", Compared::kSemiImplicit},
       {"forward_euler", Compared::kForwardEuler}}};
  const auto* const found =
      std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return name == entry.first; });
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

template <class T>
Status declare_scheme(Compared scheme, World<T>& world) {
  switch (scheme) {
    case Compared::kBossak:
      break;
    case Compared::kBdf2:
      return world.template declare<Bdf2>();
    case Compared::kBdf1:
      return world.template declare<Bdf1>();
    case Compared::kMomentum:
      return world.template declare<Momentum>();
    case Compared::kSemiImplicit:
      return world.template declare<SemiImplicit>();
    case Compared::kForwardEuler:
      return world.template declare<ForwardEuler>();
  }
  return {};
}

template class Bdf1<float>;
template class Bdf1<double>;
template class Momentum<float>;
template class Momentum<double>;
template class Bdf2<float>;
template class Bdf2<double>;
template Status declare_scheme<float>(Compared, World<float>&);
template Status declare_scheme<double>(Compared, World<double>&);

}  // namespace sinew::study
