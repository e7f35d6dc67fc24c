#include "sinew/effects/impulse.h"

namespace sinew {
namespace {

/// Where a force acts now.
template <class T>
Vec3<T> point_of(const ExternalForce<T>& push, const Kinematics<T>& kinematics) {
  return kinematics.origin[push.body] + kinematics.rotation[push.body] * push.local;
}

template <class T>
double add_gradient(const ExternalForce<T>& push, const Kinematics<T>& kinematics, const Wrenches<T>& out) {
  const Vec3<T> x = point_of(push, kinematics);
  out.force[push.body] -= push.force;
  out.moment[push.body] -= x.cross(push.force);
  return -double(push.force.dot(x));
}

template <class T>
void add_curvature(const ExternalForce<T>& push, const Kinematics<T>& kinematics,
                   std::span<Composite<T>> out) {
  out[push.body].add_force(point_of(push, kinematics), -push.force);
}

template <class T>
constexpr PushTerm<T> kPushes{add_gradient<T>, add_curvature<T>};

}  // namespace

template <class T>
void Impulses<T>::declare(StepPlan<T>& plan) {
  plan.impulses = &kPushes<T>;
}

template struct Impulses<float>;
template struct Impulses<double>;

}  // namespace sinew
