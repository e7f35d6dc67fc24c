// Impulses and pushes: forces on material points of bodies, constant over the step
// (Character::apply_impulse).
#pragma once

#include "sinew/effects/effect.h"
#include "sinew/effects/step_plan.h"

namespace sinew {

/// A force on a point of a body, which moves with it.
template <class T>
struct ExternalForce {
  int body = 0;                     ///< of its tree
  Vec3<T> local = Vec3<T>::Zero();  ///< the point, m, body axes
  Vec3<T> force = Vec3<T>::Zero();  ///< world, N
};

/// What a push does in a step.
template <class T>
struct PushTerm {
  /// Energy −F·x (J), its gradient added to `out`: what muscles must bear, too.
  double (*add_gradient)(const ExternalForce<T>& push, const Kinematics<T>& kinematics,
                         const Wrenches<T>& out);
  /// Its second derivative: what turning the body does to the force's moment.
  void (*add_curvature)(const ExternalForce<T>& push, const Kinematics<T>& kinematics,
                        std::span<Composite<T>> out);
};

/// What World::declare takes. Without, Character::apply_impulse is refused.
template <class T>
struct Impulses {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct Impulses<float>;
extern template struct Impulses<double>;

}  // namespace sinew
