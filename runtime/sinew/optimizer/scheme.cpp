#include "sinew/optimizer/scheme.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace sinew {

// Zeros, not garbage: what lies before the first state is multiplied by 0, which NaN would survive.
template <class T>
History<T>::History(int bodies)
    : center(bodies, Vec3<T>::Zero()),
      center_before(center),
      velocity(center),
      velocity_before(center),
      rotation(bodies, Mat3<T>::Identity()),
      rotation_before(rotation),
      rotation_rate(bodies, Mat3<T>::Zero()),
      momentum(center),
      momentum_before(center) {}

template <class T>
void History<T>::stop() {
  for (auto* v : {&velocity, &velocity_before, &momentum, &momentum_before})
    std::fill(v->begin(), v->end(), Vec3<T>(Vec3<T>::Zero()));
  std::fill(rotation_rate.begin(), rotation_rate.end(), Mat3<T>(Mat3<T>::Zero()));
  step_before = T(0);
}

template <class T>
void History<T>::slow(T factor, const Vec3<T>& shared) {
  for (Vec3<T>& v : velocity) v = shared + factor * (v - shared);
  for (Vec3<T>& l : momentum) l *= factor;
  for (Mat3<T>& r : rotation_rate) r *= factor;
  step_before = T(0);
}

template <class T>
Prediction<T>::Prediction(int bodies) : center(bodies), rotation(bodies), momentum(bodies), start(bodies) {}

namespace {

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
  T last = std::numeric_limits<T>::infinity();
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vec3<T> carried = rotation_exp<T>(-x) * l;
    const Vec3<T> error = inertia * (k1 * x - k2 * before) / h - carried;
    // The Jacobian of the first iterate serves until it stops to pay.
    const T size = error.norm();
    if (iteration == 0 || size > T(0.2) * last)
      inverse = (inertia * (k1 / h) - skew(carried) * right_jacobian(x)).inverse();
    last = size;
    Vec3<T> step = inverse * error;
    if (!step.allFinite()) return false;
    if (const T length = step.norm(); length > T(0.7)) step *= T(0.7) / length;
    x -= step;
    if (step.norm() < T(1e-6)) return x.norm() < T(2);
  }
  return false;
}

}  // namespace

template <class T>
void predict(const Tree<T>& tree, const History<T>& history, Scheme scheme, T h,
             const Vec3<double>& common_origin, Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  const bool second = scheme == Scheme::kBdf2 && history.step_before > T(0);
  out.scheme = scheme == Scheme::kMomentum ? scheme : second ? Scheme::kBdf2 : Scheme::kBdf1;
  if (!second) {
    out.weight = T(1) / (h * h);
    out.momentum_step = h;
    for (int i = 0; i < tree.bodies; ++i) {
      out.center[i] = place + history.center[i] + h * history.velocity[i];
      out.rotation[i] = history.rotation[i] + h * history.rotation_rate[i];
      out.momentum[i] = history.momentum[i];
      out.start[i] = history.rotation[i];
    }
    return;
  }
  const T w = h / history.step_before;
  const T a0 = (1 + w) * (1 + w) / (1 + 2 * w);
  const T a1 = -w * w / (1 + 2 * w);
  const T beta = (1 + w) / (1 + 2 * w);
  out.weight = T(1) / (beta * h * beta * h);
  out.momentum_step = beta * h;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> now = place + history.center[i];
    const Vec3<T> before = place + history.center_before[i];
    out.center[i] =
        a0 * now + a1 * before + beta * h * (a0 * history.velocity[i] + a1 * history.velocity_before[i]);
    out.momentum[i] = a0 * history.momentum[i] + a1 * history.momentum_before[i];
    const Mat3<T>& r0 = history.rotation[i];
    const Vec3<T> turned = rotation_log<T>(Quat<T>(Mat3<T>(history.rotation_before[i].transpose() * r0)));
    Vec3<T> x = turned * w;
    if (torque_free_rotation<T>(tree.inertia[i], r0.transpose() * out.momentum[i], turned,
                                (1 + 2 * w) / (1 + w), w * w / (1 + w), h, x)) {
      out.rotation[i] = r0 * rotation_exp<T>(x).toRotationMatrix();
    } else {
      out.rotation[i] = r0 + (beta * h) * history.rotation_rate[i] + (a1 * (history.rotation_before[i] - r0));
    }
  }
}

namespace {

/// Moves a history's place on to the root of `kinematics`; returns by how much.
template <class T>
Vec3<T> follow_root(const Kinematics<T>& kinematics, const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> before = (history.place - common_origin).template cast<T>();
  history.place = common_origin + kinematics.origin[0].template cast<double>();
  return kinematics.origin[0] - before;
}

}  // namespace

template <class T>
void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
             std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  const bool second = prediction.scheme == Scheme::kBdf2;
  // Backward difference of the last three (or two) states; the same coefficients serve positions and
  // rotations.
  const T w = second ? h / history.step_before : T(0);
  const T k1 = second ? (1 + 2 * w) / (1 + w) : T(1);
  const T k2 = second ? w * w / (1 + w) : T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> c1 = kinematics.center[i] - kinematics.origin[0];
    const Vec3<T> c0 = history.center[i] - moved, before = history.center_before[i] - moved;
    const Mat3<T>& r1 = kinematics.rotation[i];
    const Vec3<T> velocity = (k1 * (c1 - c0) - k2 * (c0 - before)) / h;
    const Mat3<T> rate =
        (k1 * (r1 - history.rotation[i]) - k2 * (history.rotation[i] - history.rotation_before[i])) / h;
    history.center_before[i] = c0;
    history.center[i] = c1;
    history.velocity_before[i] = history.velocity[i];
    history.velocity[i] = velocity;
    history.rotation_before[i] = history.rotation[i];
    history.rotation[i] = r1;
    history.rotation_rate[i] = rate;
    history.momentum_before[i] = history.momentum[i];
    history.momentum[i] = prediction.momentum[i] + prediction.momentum_step * torque[i];
  }
  history.scheme = prediction.scheme;
  history.step_before = h;
}

template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = kinematics.rotation[i];
    history.center_before[i] = history.center[i] - moved;
    history.center[i] = kinematics.center[i] - kinematics.origin[0];
    history.velocity_before[i] = history.velocity[i];
    history.velocity[i] = motion.velocity[i];
    history.rotation_before[i] = history.rotation[i];
    history.rotation[i] = r;
    history.rotation_rate[i] = skew<T>(motion.omega[i]) * r;
    history.momentum_before[i] = history.momentum[i];
    history.momentum[i] = r * (tree.inertia[i] * (r.transpose() * motion.omega[i]));
  }
  history.scheme = Scheme::kBdf2;
  history.step_before = h;
}

template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity) {
  Totals sum;
  double mass = 0;
  Vec3<double> first = Vec3<double>::Zero(), about_origin = Vec3<double>::Zero();
  for (int i = 0; i < tree.bodies; ++i) {
    const double m = double(tree.mass[i]);
    const Vec3<double> center = history.place + history.center[i].template cast<double>();
    const Vec3<double> velocity = history.velocity[i].template cast<double>();
    const Vec3<T> spin = history.rotation[i].transpose() * history.momentum[i];
    const Mat3<T>& rate = history.rotation_rate[i];
    const T turning = history.scheme == Scheme::kBdf1
                          ? (rate * tree.second_moment[i]).cwiseProduct(rate).sum()
                          : spin.dot(tree.inverse_inertia[i] * spin);
    sum.kinetic_energy += 0.5 * (m * velocity.squaredNorm() + double(turning));
    sum.potential_energy -= m * gravity.dot(center);
    sum.momentum += m * velocity;
    about_origin += m * center.cross(velocity) + history.momentum[i].template cast<double>();
    mass += m;
    first += m * center;
  }
  if (mass > 0) sum.angular_momentum = about_origin - first.cross(sum.momentum) / mass;
  return sum;
}

SINEW_SCHEME_INSTANCES(template, float)
SINEW_SCHEME_INSTANCES(template, double)

}  // namespace sinew
