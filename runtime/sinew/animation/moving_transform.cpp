#include "sinew/animation/moving_transform.h"

#include "sinew/animation/kernels/jet_algebra.h"

namespace sinew {

template <class T>
Quat<TimeJet<T>> shortest_arc(const MovingVector<T>& from, const MovingVector<T>& to) {
  const TimeJet<T> lengths = sqrt(from.squaredNorm() * to.squaredNorm());
  Quat<TimeJet<T>> arc;
  arc.vec() = from.cross(to);
  arc.w() = lengths + from.dot(to);
  const TimeJet<T> norm = sqrt(arc.squaredNorm());
  for (int i = 0; i < 4; ++i) arc.coeffs()[i] /= norm;
  return arc;
}

template <class T>
MovingTransform<T> moving_transform(const JointJet<T>& jet) {
  MovingTransform<T> moving;
  TimeJet<T> q[4];
  quaternion_jet(jet.rotation.coeffs().data(), jet.omega.data(), jet.alpha.data(), q);
  moving.rotation = Quat<TimeJet<T>>(q[3], q[0], q[1], q[2]);
  for (int i = 0; i < 3; ++i)
    moving.translation[i] = {jet.translation[i], jet.velocity[i], jet.acceleration[i]};
  return moving;
}

template <class T>
void set_rotation(const Quat<TimeJet<T>>& rotation, JointJet<T>& jet) {
  T p[4], dp[4], ddp[4], q[4], omega[3], alpha[3];
  for (int i = 0; i < 4; ++i) {
    const TimeJet<T>& x = rotation.coeffs()[i];
    p[i] = x.value;
    dp[i] = x.rate;
    ddp[i] = x.acceleration;
  }
  project(p, dp, ddp, q, omega, alpha);
  jet.rotation = Quat<T>(q[3], q[0], q[1], q[2]);
  jet.omega << omega[0], omega[1], omega[2];
  jet.alpha << alpha[0], alpha[1], alpha[2];
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
