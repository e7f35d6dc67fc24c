#include "sinew/animation/moving_transform.h"

#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {
namespace {

template <class T>
MovingVector<T> moving_vector(const Vec3<T>& value, const Vec3<T>& rate, const Vec3<T>& acceleration) {
  const auto component = [&](int i) { return TimeJet<T>(value[i], rate[i], acceleration[i]); };
  return {component(0), component(1), component(2)};
}

/// Quaternion of the turn between two directions, times the product of their lengths.
template <class T>
Quat<TimeJet<T>> arc_between(const MovingVector<T>& from, const MovingVector<T>& to,
                             const TimeJet<T>& lengths) {
  const MovingVector<T> axis = from.cross(to);
  return {lengths + from.dot(to), axis.x(), axis.y(), axis.z()};
}
template <class T>
TimeJet<T> product_of_lengths(const MovingVector<T>& a, const MovingVector<T>& b) {
  return sqrt(a.squaredNorm() * b.squaredNorm());
}

}  // namespace

template <class T>
MovingRotation<T> MovingRotation<T>::operator*(const MovingRotation& child) const {
  const Mat3<T> turn = child.value.toRotationMatrix();
  const Vec3<T> carried = turn.transpose() * omega;
  return {value * child.value, carried + child.omega,
          turn.transpose() * alpha + child.alpha + carried.cross(child.omega)};
}

template <class T>
MovingVector<T> MovingRotation<T>::operator*(const MovingVector<T>& v) const {
  const Mat3<T> turn = value.toRotationMatrix();
  const Vec3<T> at = value_of<T>(v), along = rate_of<T>(v), rate = along + omega.cross(at);
  return moving_vector<T>(
      turn * at, turn * rate,
      turn * (acceleration_of<T>(v) + omega.cross(Vec3<T>(rate + along)) + alpha.cross(at)));
}

template <class T>
MovingVector<T> MovingRotation<T>::operator*(const Vec3<T>& v) const {
  const Mat3<T> turn = value.toRotationMatrix();
  const Vec3<T> rate = omega.cross(v);
  return moving_vector<T>(turn * v, turn * rate, turn * (omega.cross(rate) + alpha.cross(v)));
}

template <class T>
MovingRotation<T> MovingRotation<T>::conjugate() const {
  const Mat3<T> turn = value.toRotationMatrix();
  return {value.conjugate(), -(turn * omega), -(turn * alpha)};
}

template <class T>
MovingRotation<T> moving_rotation(const Quat<TimeJet<T>>& quaternion) {
  T p[4], dp[4], ddp[4], q[4], omega[3], alpha[3];
  for (int i = 0; i < 4; ++i) {
    const TimeJet<T>& x = quaternion.coeffs()[i];
    p[i] = x.value;
    dp[i] = x.rate;
    ddp[i] = x.acceleration;
  }
  project(p, dp, ddp, q, omega, alpha);
  return {{q[3], q[0], q[1], q[2]}, {omega[0], omega[1], omega[2]}, {alpha[0], alpha[1], alpha[2]}};
}

template <class T>
Quat<TimeJet<T>> moving_quaternion(const MovingRotation<T>& rotation) {
  TimeJet<T> q[4];
  quaternion_jet(rotation.value.coeffs().data(), rotation.omega.data(), rotation.alpha.data(), q);
  return {q[3], q[0], q[1], q[2]};
}

template <class T>
MovingRotation<T> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to) {
  return moving_rotation(arc_between<T>(from, to, product_of_lengths<T>(from, to)));
}

template <class T>
MovingRotation<T> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to,
                               const TimeJet<T>& part) {
  const TimeJet<T> lengths = product_of_lengths<T>(from, to);
  Quat<TimeJet<T>> arc = arc_between<T>(from, to, lengths);
  const TimeJet<T> length = sqrt(T(2) * (lengths * arc.w()));
  for (int i = 0; i < 4; ++i) arc.coeffs()[i] *= part;
  arc.w() += (TimeJet<T>(T(1)) - part) * length;
  return moving_rotation(arc);
}

template <class T>
MovingTransform<T> moving_transform(const JointJet<T>& jet) {
  return {moving_rotation(jet), moving_vector<T>(jet.translation, jet.velocity, jet.acceleration)};
}

template <class T>
void set_rotation(const MovingRotation<T>& rotation, JointJet<T>& jet) {
  jet.rotation = rotation.value;
  renormalize(jet.rotation);  // products of many are one but for rounding
  jet.omega = rotation.omega;
  jet.alpha = rotation.alpha;
}

template <class T>
JointJet<T> joint_jet(const MovingTransform<T>& moving) {
  JointJet<T> jet;
  set_rotation(moving.rotation, jet);
  jet.translation = value_of<T>(moving.translation);
  jet.velocity = rate_of<T>(moving.translation);
  jet.acceleration = acceleration_of<T>(moving.translation);
  return jet;
}

template <class T>
MovingTransform<T> model_motion(std::span<const JointJet<T>> jets, std::span<const int> parents, int joint,
                                int ancestor) {
  MovingTransform<T> frame = moving_transform(jets[joint]);
  for (int i = parents[joint]; i > ancestor; i = parents[i]) frame = moving_transform(jets[i]) * frame;
  return frame;
}

SINEW_MOVING_INSTANCES(template, float)
SINEW_MOVING_INSTANCES(template, double)

}  // namespace sinew
