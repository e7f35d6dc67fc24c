// Blend of two poses with exact velocities and accelerations.
#pragma once

#include <algorithm>
#include <span>

#include "sinew/animation/blending_job.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// A weight and its first two time derivatives. A weight that is not C² injects torque.
template <class T>
struct EaseWeight : TimeJet<T> {
  using TimeJet<T>::TimeJet;
  EaseWeight() : TimeJet<T>(T(0)) {}
  /// Quintic ease from 0 at `elapsed` = 0 to 1 at `duration` (s), flat and uncurved at both ends.
  static EaseWeight at(T elapsed, T duration) {
    if (duration <= T(0) || elapsed >= duration) return {T(1), T(0), T(0)};
    if (elapsed <= T(0)) return {};
    const T u = elapsed / duration, u2 = u * u;
    const T value = std::min(T(1), u2 * u * (T(10) - T(15) * u + T(6) * u2));  // near 1 it rounds above it
    return {value, T(30) * u2 * (T(1) - u) * (T(1) - u) / duration,
            T(60) * u * (T(1) - u) * (T(1) - T(2) * u) / (duration * duration)};
  }
};

/// out = (1 − w)·a + w·b per joint with exact derivatives: the BlendingJob of two layers that needs no
/// status. 0 ≤ w ≤ 1. `out` may be `a` or `b`. Spans of equal length; `rest` as in BlendingJob.
template <class T>
void crossfade(std::span<const JointJet<T>> a, std::span<const JointJet<T>> b, const EaseWeight<T>& w,
               std::span<JointJet<T>> out, std::span<const Transform<T>> rest = {});

/// @cond
extern template void crossfade<float>(std::span<const JointJet<float>>, std::span<const JointJet<float>>,
                                      const EaseWeight<float>&, std::span<JointJet<float>>,
                                      std::span<const Transform<float>>);
extern template void crossfade<double>(std::span<const JointJet<double>>, std::span<const JointJet<double>>,
                                       const EaseWeight<double>&, std::span<JointJet<double>>,
                                       std::span<const Transform<double>>);
/// @endcond

/// Moves a pose in the world: the root's transform and motion are turned and shifted by `place`.
template <class T>
void place_root(const Transform<T>& place, JointJet<T>& root) {
  root.translation = place * root.translation;
  root.rotation = place.rotation * root.rotation;
  normalize(root.rotation);
  root.velocity = place.rotation * root.velocity;
  root.acceleration = place.rotation * root.acceleration;
}

}  // namespace sinew
