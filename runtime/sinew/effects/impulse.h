// Impulses and pushes: forces on material points of bodies, constant over the step
// (Character::apply_impulse).
#pragma once

#include "sinew/effects/effect.h"

namespace sinew {

template <class T>
struct ExternalForce {
  int body = 0;
  Vec3<T> local = Vec3<T>::Zero();  ///< body axes
  Vec3<T> force = Vec3<T>::Zero();  ///< world, N
};

/// Where a force acts now.
template <class T>
Vec3<T> point_of(const ExternalForce<T>& push, const Kinematics<T>& kinematics) {
  return kinematics.origin[push.body] + kinematics.rotation[push.body] * push.local;
}

/// Energy −F·x (J), its gradient added to `out`: what muscles must bear, too.
template <class T>
double add_gradient(const ExternalForce<T>& push, const Kinematics<T>& kinematics, const Wrenches<T>& out);

/// Its second derivative: what turning the body does to the force's moment.
template <class T>
void add_curvature(const ExternalForce<T>& push, const Kinematics<T>& kinematics,
                   std::span<Composite<T>> out);

#define SINEW_IMPULSE_INSTANCES(prefix, T)                                                          \
  prefix double add_gradient<T>(const ExternalForce<T>&, const Kinematics<T>&, const Wrenches<T>&); \
  prefix void add_curvature<T>(const ExternalForce<T>&, const Kinematics<T>&, std::span<Composite<T>>);
SINEW_IMPULSE_INSTANCES(extern template, float)
SINEW_IMPULSE_INSTANCES(extern template, double)

}  // namespace sinew
