// Gravity. It has no object of its own: the residual takes it as an acceleration of the root that every body
// shares (residual_pass.h), the step as one product per body beside inertia's.
#pragma once

#include "sinew/skeleton/vector.h"

namespace sinew {

/// Potential of a body, J: −m·g·c.
template <class T>
T gravity_energy(T mass, const Vec3<T>& gravity, const Vec3<T>& center) {
  return -(mass * gravity.dot(center));
}

/// The gradient of that by the body's place, N.
template <class T>
Vec3<T> gravity_gradient(T mass, const Vec3<T>& gravity) {
  return -(mass * gravity);
}

}  // namespace sinew
