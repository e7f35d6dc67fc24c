#include "sinew/optimizer/scheme.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <numeric>

#include "sinew/effects/gravity.h"
#include "sinew/optimizer/bossak.h"

namespace sinew {

template <class T>
History<T>::History(int bodies)
    : center(bodies, Vec3<T>::Zero()),
      velocity(center),
      rotation(bodies, Mat3<T>::Identity()),
      rotation_rate(bodies, Mat3<T>::Zero()),
      momentum(center),
      acceleration(center),
      torque(center) {}

template <class T>
void History<T>::stop() {
  for (auto* v : {&velocity, &momentum, &acceleration, &torque})
    std::fill(v->begin(), v->end(), Vec3<T>(Vec3<T>::Zero()));
  std::fill(rotation_rate.begin(), rotation_rate.end(), Mat3<T>(Mat3<T>::Zero()));
  step_before = T(0);
  other.clear();
  accelerates = false;
}

template <class T>
Prediction<T>::Prediction(int bodies) : center(bodies), rotation(bodies), momentum(bodies) {}

namespace {

constexpr int kMostRotationParts = 64;  ///< of a free body's turn in one step

template <class T>
Mat3<T> world_inertia(const Tree<T>& tree, const History<T>& history, int i) {
  const Mat3<T>& r = history.rotation[i];
  const Mat3<T> turned = r.lazyProduct(tree.inertia[i]);
  return turned.lazyProduct(r.transpose());
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
void predict_euler(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
                   Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  out.other = nullptr;
  out.rho = T(0);
  out.weight = T(1) / (h * h);
  out.momentum_step = h;
  for (int i = 0; i < tree.bodies; ++i) {
    out.center[i] = place + history.center[i] + h * history.velocity[i];
    out.rotation[i] = history.rotation[i] + h * history.rotation_rate[i];
    out.momentum[i] = history.momentum[i];
  }
}

template <class T>
void predict_at_rest(const Tree<T>& tree, const History<T>& history, std::span<const Vec3<T>> force,
                     std::span<const Vec3<T>> couple, T span, const Vec3<double>& common_origin,
                     Prediction<T>& out) {
  const Vec3<T> place = (history.place - common_origin).template cast<T>();
  out.other = nullptr;
  out.rho = T(0);
  out.weight = T(1) / span;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = history.rotation[i];
    out.center[i] = place + history.center[i];
    if (tree.mass[i] > T(0)) out.center[i] -= span / tree.mass[i] * force[i];
    const Vec3<T> back = tree.inverse_inertia[i] * (r.transpose() * couple[i]);
    out.rotation[i] = r * rotation_exp<T>(-span * back).toRotationMatrix();
  }
}

template <class T>
Vec3<T> follow_root(const Kinematics<T>& kinematics, const Vec3<double>& common_origin, History<T>& history) {
  const Vec3<T> before = (history.place - common_origin).template cast<T>();
  history.place = common_origin + kinematics.origin[0].template cast<double>();
  return kinematics.origin[0] - before;
}

template <class T>
Vec3<double> linear_momentum(const Tree<T>& tree, const History<T>& history) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (int i = 0; i < tree.bodies; ++i)
    sum += double(tree.mass[i]) * history.velocity[i].template cast<double>();
  return sum;
}

template <class T>
void set_momentum(const Tree<T>& tree, const Vec3<double>& momentum, History<T>& history) {
  // m/s: what is kept for ever must not be kept below what processors calculate with at full speed.
  constexpr double kNone = 1e-30;
  const double mass = std::accumulate(tree.mass.begin(), tree.mass.end(), 0.0);
  const bool rests = momentum.cwiseAbs().maxCoeff() < kNone * mass;
  const Vec3<double> wanted = rests ? Vec3<double>(Vec3<double>::Zero()) : momentum;
  const Vec3<T> push = ((wanted - linear_momentum<T>(tree, history)) / mass).template cast<T>();
  for (Vec3<T>& velocity : history.velocity) velocity += push;
}

template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<T>& gravity, const Vec3<double>& common_origin, History<T>& history) {
  (void)follow_root(kinematics, common_origin, history);
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = kinematics.rotation[i];
    history.center[i] = kinematics.center[i] - kinematics.origin[0];
    history.velocity[i] = motion.velocity[i];
    history.rotation[i] = r;
    history.rotation_rate[i] = skew<T>(motion.omega[i]) * r;
    history.momentum[i] = r * (tree.inertia[i] * (r.transpose() * motion.omega[i]));
    const BodyMotion<T>& body = motion.body[i];
    history.acceleration[i] =
        tree.mass[i] > T(0) ? Vec3<T>(gravity + r * body.force / tree.mass[i]) : Vec3<T>(Vec3<T>::Zero());
    history.torque[i] = r * Vec3<T>(body.moment - tree.center_of_mass[i].cross(body.force));
  }
  history.accelerates = true;
  history.step_before = h;
  history.other.clear();
  history.turns_as_differenced = false;
}

namespace {

/// Totals, body by body. `place` (m, world) is where centres are given from.
class TotalsSum {
 public:
  TotalsSum(const Vec3<double>& place, const Vec3<double>& gravity) : place_(place), gravity_(gravity) {}

  /// `turning`: twice the energy of its turning, J; `momentum`: angular, about its centre.
  void add(double mass, const Vec3<double>& center, const Vec3<double>& velocity, double turning,
           const Vec3<double>& momentum) {
    sum_.kinetic_energy += 0.5 * (mass * velocity.squaredNorm() + turning);
    sum_.potential_energy += gravity_energy<double>(mass, gravity_, place_ + center);
    sum_.momentum += mass * velocity;
    about_place_ += mass * center.cross(velocity) + momentum;
    mass_ += mass;
    first_ += mass * center;
  }
  Totals get() {
    if (mass_ > 0) sum_.angular_momentum = about_place_ - first_.cross(sum_.momentum) / mass_;
    return sum_;
  }

 private:
  Totals sum_;
  Vec3<double> place_, gravity_, first_ = Vec3<double>::Zero(), about_place_ = Vec3<double>::Zero();
  double mass_ = 0;
};

}  // namespace

template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity) {
  TotalsSum sum(history.place, gravity);
  for (int i = 0; i < tree.bodies; ++i) {
    const Vec3<T> spin = history.rotation[i].transpose() * history.momentum[i];
    const Mat3<T>& rate = history.rotation_rate[i];
    const T turning = history.turns_as_differenced ? (rate * tree.second_moment[i]).cwiseProduct(rate).sum()
                                                   : spin.dot(tree.inverse_inertia[i] * spin);
    sum.add(double(tree.mass[i]), history.center[i].template cast<double>(),
            history.velocity[i].template cast<double>(), double(turning),
            history.momentum[i].template cast<double>());
  }
  return sum.get();
}

template <class T>
Totals totals(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<double>& gravity,
              Kinematics<T>& k, Motion<T>& m) {
  TotalsSum sum(jets[0].translation.template cast<double>(), gravity);
  for (int i = 0; i < tree.bodies; ++i) {
    const JointJet<T>& jet = jets[i];
    const Mat3<T> turn = jet.rotation.toRotationMatrix();
    Vec3<T>& omega = m.body[i].omega;
    if (const int p = tree.parent[i]; p < 0) {
      k.rotation[i] = turn;
      k.origin[i].setZero();
      m.origin_velocity[i] = jet.velocity;
      omega = jet.omega;
    } else {
      const Vec3<T>&arm = jet.translation, &around = m.body[p].omega;
      k.rotation[i].noalias() = k.rotation[p].lazyProduct(turn);
      k.origin[i] = k.origin[p] + k.rotation[p] * arm;
      m.origin_velocity[i] = m.origin_velocity[p] + k.rotation[p] * Vec3<T>(around.cross(arm) + jet.velocity);
      omega = turn.transpose() * around + jet.omega;
    }
    const Vec3<T>& center = tree.center_of_mass[i];
    const Vec3<T> spun = tree.inertia[i] * omega;
    const Vec3<T> at = k.origin[i] + k.rotation[i] * center;
    const Vec3<T> velocity = m.origin_velocity[i] + k.rotation[i] * Vec3<T>(omega.cross(center));
    const Vec3<T> momentum = k.rotation[i] * spun;
    sum.add(double(tree.mass[i]), at.template cast<double>(), velocity.template cast<double>(),
            double(omega.dot(spun)), momentum.template cast<double>());
  }
  return sum.get();
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
  const Vec3<T> center = rigid.center.template cast<T>(), spin = rigid.spin.template cast<T>(),
                velocity = rigid.velocity.template cast<T>();
  // What is rigid in the motion, and keeps its speed, is added to the scaled whole.
  const Vec3<T> added = turn.template cast<T>() - (factor - 1) * spin;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T>& r = history.rotation[i];
    const Vec3<T> arm = history.center[i] - center;
    history.velocity[i] += (factor - 1) * (history.velocity[i] - velocity) + added.cross(arm);
    history.momentum[i] +=
        (factor - 1) * history.momentum[i] + Vec3<T>(r * (tree.inertia[i] * (r.transpose() * added)));
    Mat3<T>& rate = history.rotation_rate[i];
    if (history.turns_as_differenced)
      rate += (factor - 1) * rate + skew<T>(added) * r;
    else
      rate = rotation_rate_of<T>(tree, i, r, history.momentum[i]);
  }
  constexpr T kBears = T(0.99);  // what another scheme keeps of earlier velocities bears such a change
  if (factor < kBears) history.other.clear();
}

SINEW_SCHEME_INSTANCES(template, float)
SINEW_SCHEME_INSTANCES(template, double)

}  // namespace sinew
