#include "sinew/optimizer/scheme.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <numeric>

#include "sinew/effects/gravity.h"
#include "sinew/optimizer/bossak.h"

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
      momentum_before(center),
      acceleration(center),
      torque(center) {}

template <class T>
void History<T>::stop() {
  for (auto* v : {&velocity, &velocity_before, &momentum, &momentum_before, &acceleration, &torque})
    std::fill(v->begin(), v->end(), Vec3<T>(Vec3<T>::Zero()));
  std::fill(rotation_rate.begin(), rotation_rate.end(), Mat3<T>(Mat3<T>::Zero()));
  step_before = T(0);
  accelerates = false;
}

template <class T>
Prediction<T>::Prediction(int bodies) : center(bodies), rotation(bodies), momentum(bodies), start(bodies) {}

namespace {

constexpr int kMostRotationParts = 64;  ///< of a free body's turn in one step

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

template <class T>
Mat3<T> world_inertia(const Tree<T>& tree, const History<T>& history, int i) {
  const Mat3<T>& r = history.rotation[i];
  const Mat3<T> turned = r.lazyProduct(tree.inertia[i]);
  return turned.lazyProduct(r.transpose());
}

/// Angular velocity (rad/s, body axes) of a state that was set, not differenced.
template <class T>
Vec3<T> spin_at_start(const History<T>& history, int i) {
  const Mat3<T> spin = history.rotation[i].transpose() * history.rotation_rate[i];
  return Vec3<T>(spin(2, 1) - spin(1, 2), spin(0, 2) - spin(2, 0), spin(1, 0) - spin(0, 1)) / 2;
}

/// Of the whole tree, were its joints locked, about its centre of mass (m, from the history's place); world
/// axes.
template <class T>
Mat3<T> locked_inertia(const Tree<T>& tree, const History<T>& history, const Vec3<T>& center) {
  Mat3<T> sum = Mat3<T>::Zero();
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> arm = history.center[i] - center;
    sum += world_inertia(tree, history, i) +
           tree.mass[i] * (arm.squaredNorm() * Mat3<T>::Identity() - arm * arm.transpose());
  }
  return sum;
}

}  // namespace

template <class T>
Mat3<T> free_rotation(const Mat3<T>& inverse_inertia, const Mat3<T>& start, const Vec3<T>& momentum, T h) {
  // In the body's axes: l = Rᵀ L and its derivatives, l' = l × ω, and those of ω = I⁻¹ l.
  Vec3<T> l = start.transpose() * momentum, w = inverse_inertia * l;
  const T angle = std::abs(h) * w.norm();
  constexpr T kPart = T(0.15);
  const bool countable = angle < kPart * (kMostRotationParts - 1);  // not so where it is no number
  const int parts = countable ? static_cast<int>(angle / kPart) + 1 : kMostRotationParts;
  const T t = h / T(parts);
  Mat3<T> rotation = start;
  for (int n = 0; n < parts; ++n) {
    const Vec3<T> l1 = l.cross(w), w1 = inverse_inertia * l1;
    const Vec3<T> l2 = l1.cross(w) + l.cross(w1), w2 = inverse_inertia * l2;
    const Vec3<T> l3 = l2.cross(w) + 2 * l1.cross(w1) + l.cross(w2), w3 = inverse_inertia * l3;
    const Vec3<T> high = (2 * w2 + w.cross(w1)) / 12 + t / 24 * (w3 + w.cross(w2));
    const Mat3<T> turn = rotation_exp<T>(t * (w + t * (w1 / 2 + t * high))).toRotationMatrix();
    rotation = Mat3<T>(rotation * turn);
    if (n + 1 == parts) break;
    l = Vec3<T>(turn.transpose() * l);
    w = inverse_inertia * l;
  }
  return rotation;
}

template Mat3<float> free_rotation<float>(const Mat3<float>&, const Mat3<float>&, const Vec3<float>&, float);
template Mat3<double> free_rotation<double>(const Mat3<double>&, const Mat3<double>&, const Vec3<double>&,
                                            double);

template <class T>
void predict(const Tree<T>& tree, const History<T>& history, Scheme scheme, T h,
             const Vec3<double>& common_origin, Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  const bool second = scheme == Scheme::kBdf2 && history.step_before > T(0);
  out.exact = out.first = false;
  out.scheme = scheme == Scheme::kMomentum ? scheme : second ? Scheme::kBdf2 : Scheme::kBdf1;
  if (!second) {
    out.weight = T(1) / (h * h);
    out.momentum_step = h;
    out.k1 = T(1), out.k2 = T(0);
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
  const T k1 = out.k1 = (1 + 2 * w) / (1 + w), k2 = out.k2 = w * w / (1 + w);
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
    if (torque_free_rotation<T>(tree.inertia[i], r0.transpose() * out.momentum[i], turned, k1, k2, h, x)) {
      out.rotation[i] = r0 * rotation_exp<T>(x).toRotationMatrix();
    } else {
      out.rotation[i] = r0 + (beta * h) * history.rotation_rate[i] + (a1 * (history.rotation_before[i] - r0));
    }
  }
}

template <class T>
void predict_at_rest(const Tree<T>& tree, const History<T>& history, std::span<const Vec3<T>> force,
                     std::span<const Vec3<T>> couple, T span, const Vec3<double>& common_origin,
                     Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  out.exact = out.first = false;
  out.scheme = Scheme::kBdf1;
  out.weight = T(1) / span;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = history.rotation[i];
    out.center[i] = place + history.center[i];
    if (tree.mass[i] > T(0)) out.center[i] -= span / tree.mass[i] * force[i];
    const Vec3<T> back = tree.inverse_inertia[i] * (r.transpose() * couple[i]);
    out.rotation[i] = r * rotation_exp<T>(-span * back).toRotationMatrix();
    out.start[i] = r;
  }
}

template <class T>
void predict_first(const Tree<T>& tree, const History<T>& history, const Kinematics<T>& kinematics,
                   std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
                   Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  out.first = true;
  out.scheme = Scheme::kBdf2;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> acceleration = out.weight * (kinematics.center[i] - out.center[i]);
    out.center[i] = place + history.center[i] + h * history.velocity[i] + h * h / 4 * acceleration;
    out.momentum[i] = history.momentum[i] + h / 2 * torque[i];
    const Mat3<T>& r0 = history.rotation[i];
    const Vec3<T> turned = h * spin_at_start(history, i);
    Vec3<T> x = turned;
    if (!torque_free_rotation<T>(tree.inertia[i], r0.transpose() * out.momentum[i], turned, T(2), T(1), h, x))
      x = turned;
    out.rotation[i] = r0 * rotation_exp<T>(x).toRotationMatrix();
  }
  out.weight = 4 / (h * h);
  out.momentum_step = h / 2;
  out.k1 = T(2), out.k2 = T(1);
}

template <class T>
void predict_free_flight(const Tree<T>& tree, const History<T>& history, T h, Prediction<T>& out) {
  if (out.scheme != Scheme::kBdf2 || tree.type[0] != JointType::kFree || tree.dofs != 6) return;
  out.exact = true;
  T mass = T(0);
  Vec3<T> center = Vec3<T>::Zero(), velocity = center, predicted = center;
  for (int i = 0; i < tree.bodies; ++i) {
    mass += tree.mass[i];
    center += tree.mass[i] * history.center[i];
    velocity += tree.mass[i] * history.velocity[i];
    predicted += tree.mass[i] * out.center[i];
  }
  center /= mass, velocity /= mass, predicted /= mass;
  const Mat3<T>& r0 = history.rotation[0];
  Vec3<T> momentum = Vec3<T>::Zero();
  for (int i = 0; i < tree.bodies; ++i)
    momentum += history.momentum[i] +
                tree.mass[i] * (history.center[i] - center).cross(history.velocity[i] - velocity);
  const Mat3<T> inertia = r0.transpose() * locked_inertia(tree, history, center) * r0;
  // A rod has no inertia about itself, and nothing to keep there.
  const T thin = 100 * std::numeric_limits<T>::epsilon() * inertia.trace();
  const Mat3<T> inverse = (inertia + thin * Mat3<T>::Identity()).inverse();
  const Quat<T> now(r0);
  const auto turn = [&](T seconds) {
    return Vec3<T>(rotation_log<T>(now.conjugate() * Quat<T>(free_rotation<T>(inverse, r0, momentum, seconds))));
  };
  const Vec3<T> exact = turn(h);
  const Vec3<T> before =
      out.first ? Vec3<T>(h * (inverse * (r0.transpose() * momentum))) : Vec3<T>(-turn(-history.step_before));
  const auto turned_by = [&](const Quat<T>& q) {
    return Mat3<T>((now * q * now.conjugate()).toRotationMatrix());
  };
  Vec3<T> x = exact;
  if (torque_free_rotation<T>(inertia, r0.transpose() * momentum, before, out.k1, out.k2, h, x)) {
    const Mat3<T> missed = turned_by(rotation_exp<T>(exact) * rotation_exp<T>(-x));
    for (int i = 0; i < tree.bodies; ++i) {
      out.rotation[i] = missed * out.rotation[i];
      out.center[i] = predicted + missed * (out.center[i] - predicted);
    }
    return;
  }
  const Mat3<T> turned = turned_by(rotation_exp<T>(exact));
  for (int i = 0; i < tree.bodies; ++i) {
    out.rotation[i] = turned * history.rotation[i];
    out.center[i] = predicted + turned * (history.center[i] - center);
  }
}

template <class T>
Vec3<T> follow_root(const Kinematics<T>& kinematics, const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> before = (history.place - common_origin).template cast<T>();
  history.place = common_origin + kinematics.origin[0].template cast<double>();
  return kinematics.origin[0] - before;
}

template <class T>
void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
             std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> moved = follow_root(kinematics, common_origin, history);
  // Backward difference of the last three (or two) states; the same coefficients serve positions and
  // rotations.
  const T k1 = prediction.k1, k2 = prediction.k2;
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> c1 = kinematics.center[i] - kinematics.origin[0];
    const Vec3<T> c0 = history.center[i] - moved, before = history.center_before[i] - moved;
    const Mat3<T>& r1 = kinematics.rotation[i];
    const Vec3<T> moved_before = prediction.first ? Vec3<T>(h * history.velocity[i]) : Vec3<T>(c0 - before);
    const Mat3<T> turned_before = prediction.first
                                      ? Mat3<T>(h * history.rotation_rate[i])
                                      : Mat3<T>(history.rotation[i] - history.rotation_before[i]);
    const Vec3<T> velocity = (k1 * (c1 - c0) - k2 * moved_before) / h;
    const Mat3<T> rate = (k1 * (r1 - history.rotation[i]) - k2 * turned_before) / h;
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
  history.changed = {};
}

namespace {

template <class T>
Vec3<double> linear_momentum(const Tree<T>& tree, std::span<const Vec3<T>> velocity) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (int i = 0; i < tree.bodies; ++i) sum += double(tree.mass[i]) * velocity[i].template cast<double>();
  return sum;
}

}  // namespace

template <class T>
Vec3<double> carried_momentum(const Tree<T>& tree, const History<T>& history, const Prediction<T>& prediction,
                              T h) {
  const Vec3<double> now = linear_momentum<T>(tree, history.velocity);
  if (prediction.scheme != Scheme::kBdf2 || prediction.first) return now;
  const double w = double(h) / double(history.step_before);
  return now + w * w / (1 + 2 * w) * (now - linear_momentum<T>(tree, history.velocity_before));
}

template <class T>
void set_momentum(const Tree<T>& tree, const Vec3<double>& momentum, History<T>& history) {
  // m/s: what is kept for ever must not be kept below what processors calculate with at full speed.
  constexpr double kNone = 1e-30;
  const double mass = std::accumulate(tree.mass.begin(), tree.mass.end(), 0.0);
  const bool rests = momentum.cwiseAbs().maxCoeff() < kNone * mass;
  const Vec3<double> wanted = rests ? Vec3<double>(Vec3<double>::Zero()) : momentum;
  history.changed.push = ((wanted - linear_momentum<T>(tree, history.velocity)) / mass).template cast<T>();
  for (Vec3<T>& velocity : history.velocity) velocity += history.changed.push;
}

template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<T>& gravity, const Vec3<double>& common_origin, History<T>& history) {
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
    const BodyMotion<T>& body = motion.body[i];
    history.acceleration[i] =
        tree.mass[i] > T(0) ? Vec3<T>(gravity + r * body.force / tree.mass[i]) : Vec3<T>(Vec3<T>::Zero());
    history.torque[i] = r * Vec3<T>(body.moment - tree.center_of_mass[i].cross(body.force));
  }
  history.accelerates = true;
  history.scheme = Scheme::kBdf2;
  history.step_before = h;
  history.changed = {};
}

template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity) {
  Totals sum;
  double mass = 0;
  Vec3<double> first = Vec3<double>::Zero(), about_place = Vec3<double>::Zero();
  for (int i = 0; i < tree.bodies; ++i) {
    const double m = double(tree.mass[i]);
    const Vec3<double> center = history.center[i].template cast<double>();
    const Vec3<double> velocity = history.velocity[i].template cast<double>();
    const Vec3<T> spin = history.rotation[i].transpose() * history.momentum[i];
    const Mat3<T>& rate = history.rotation_rate[i];
    const T turning = history.scheme == Scheme::kBdf1
                          ? (rate * tree.second_moment[i]).cwiseProduct(rate).sum()
                          : spin.dot(tree.inverse_inertia[i] * spin);
    sum.kinetic_energy += 0.5 * (m * velocity.squaredNorm() + double(turning));
    sum.potential_energy += gravity_energy<double>(m, gravity, history.place + center);
    sum.momentum += m * velocity;
    about_place += m * center.cross(velocity) + history.momentum[i].template cast<double>();
    mass += m;
    first += m * center;
  }
  if (mass > 0) sum.angular_momentum = about_place - first.cross(sum.momentum) / mass;
  return sum;
}

template <class T>
RigidMotion rigid_motion(const Tree<T>& tree, const History<T>& history, const Totals& totals) {
  RigidMotion rigid;
  double mass = 0;
  for (int i = 0; i < tree.bodies; ++i) {
    mass += double(tree.mass[i]);
    rigid.center += double(tree.mass[i]) * history.center[i].template cast<double>();
  }
  rigid.center /= mass;
  rigid.velocity = totals.momentum / mass;
  rigid.inertia = locked_inertia<T>(tree, history, rigid.center.template cast<T>()).template cast<double>();
  rigid.spin = rigid.inertia.ldlt().solve(totals.angular_momentum);
  rigid.relative_energy = totals.kinetic_energy - 0.5 * totals.momentum.squaredNorm() / mass -
                          0.5 * totals.angular_momentum.dot(rigid.spin);
  return rigid;
}

Vec3<double> RigidMotion::spin_of(const Vec3<double>& momentum) const {
  const double thin = 1e-7 * inertia.trace();
  return (inertia + thin * Mat3<double>::Identity()).ldlt().solve(momentum);
}

template <class T>
void change_motion(const Tree<T>& tree, const RigidMotion& rigid, T factor, const Vec3<double>& turn,
                   History<T>& history) {
  MotionChange<T>& change = history.changed;
  change.center = rigid.center.template cast<T>();
  change.velocity = rigid.velocity.template cast<T>();
  change.spin = rigid.spin.template cast<T>();
  change.turn = turn.template cast<T>();
  change.factor = factor;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = history.rotation[i];
    const auto momentum_of = [&](const Vec3<T>& spin) {
      return Vec3<T>(r * (tree.inertia[i] * (r.transpose() * spin)));
    };
    const Vec3<T> stronger = (factor - 1) * (history.momentum[i] - momentum_of(change.spin));
    const Vec3<T> scaled = change.scaled(history.center[i], history.velocity[i]);
    history.velocity_before[i] += scaled;
    history.velocity[i] += scaled + change.turn.cross(history.center[i] - change.center);
    history.momentum[i] += stronger + momentum_of(change.turn);
    history.momentum_before[i] += stronger;
    history.rotation_rate[i] = history.scheme == Scheme::kBossak
                                   ? rotation_rate_of<T>(tree, i, r, history.momentum[i])
                                   : history.rotation_rate[i] + change.faster(r, history.rotation_rate[i]);
  }
}

SINEW_SCHEME_INSTANCES(template, float)
SINEW_SCHEME_INSTANCES(template, double)

}  // namespace sinew
