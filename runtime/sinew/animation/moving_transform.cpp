#include "sinew/animation/moving_transform.h"

#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/pack.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {
namespace {

/// A vector in the first three lanes of four, or a quaternion.
template <class T>
using Four = Pack<T, 4>;

template <class T>
Four<T> four(const Vec3<T>& v) {
  return typename Four<T>::Vector{v[0], v[1], v[2], T(0)};
}
template <class T>
Four<T> four(const Quat<T>& q) {
  return Four<T>::load(q.coeffs().data());
}
template <class T>
Vec3<T> vector_of(const Four<T>& x) {
  return {x.v[0], x.v[1], x.v[2]};
}
/// y z x.
template <class P>
P turned_round(const P& a) {
  return rearranged<1, 2, 0, 3>(a);
}
template <class P>
P cross(const P& a, const P& b) {
  return turned_round(a * turned_round(b) - turned_round(a) * b);
}
/// A vector turned by the rotation `q`: v + w·t + q×t, t = 2q×v.
template <class P>
P turn(const P& q, const P& v) {
  const P half = cross(q, v), t = half + half;
  return v + rearranged<3, 3, 3, 3>(q) * t + cross(q, t);
}
template <class T>
TimeJet<Four<T>> fours(const MovingVector<T>& v) {
  return {four<T>(value_of<T>(v)), four<T>(rate_of<T>(v)), four<T>(acceleration_of<T>(v))};
}
template <class T>
MovingVector<T> moving_vector(const TimeJet<Four<T>>& x) {
  const auto component = [&](int i) { return TimeJet<T>(x.value.v[i], x.rate.v[i], x.acceleration.v[i]); };
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
  const Four<T> back = four(child.value.conjugate()), carried = turn(back, four(omega)),
                own = four(child.omega);
  return {value * child.value, vector_of<T>(carried + own),
          vector_of<T>(turn(back, four(alpha)) + four(child.alpha) + cross(carried, own))};
}

template <class T>
MovingVector<T> MovingRotation<T>::operator*(const MovingVector<T>& v) const {
  const Four<T> q = four(value), w = four(omega);
  const TimeJet<Four<T>> at = fours<T>(v);
  const Four<T> rate = at.rate + cross(w, at.value);
  return moving_vector<T>(
      {turn(q, at.value), turn(q, rate),
       turn(q, at.acceleration + cross(w, rate + at.rate) + cross(four(alpha), at.value))});
}

template <class T>
MovingVector<T> MovingRotation<T>::operator*(const Vec3<T>& v) const {
  const Four<T> q = four(value), w = four(omega), at = four(v), rate = cross(w, at);
  return moving_vector<T>({turn(q, at), turn(q, rate), turn(q, cross(w, rate) + cross(four(alpha), at))});
}

template <class T>
MovingRotation<T> MovingRotation<T>::conjugate() const {
  const Four<T> q = four(value);
  return {value.conjugate(), vector_of<T>(-turn(q, four(omega))), vector_of<T>(-turn(q, four(alpha)))};
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
  return {moving_rotation(jet),
          moving_vector<T>({four(jet.translation), four(jet.velocity), four(jet.acceleration)})};
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
