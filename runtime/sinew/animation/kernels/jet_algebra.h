// Quaternions in R⁴ and their projection to rotations, on any scalar: float, double, packs. Internal linkage,
// as pack.h.
#pragma once

#include "sinew/animation/time_jet.h"

namespace sinew {
namespace {

/// What p / |p| and its first two derivatives are as a rotation, angular velocity and angular acceleration in
/// child axes (coefficients x y z w). The length of p and how it changes cancel:
///     ω = 2·Im(p̄ p')/n,  α = 2·Im(p̄ p'')/n − ω·2(p·p')/n,  n = p·p
template <class S>
[[gnu::always_inline]] inline void project(const S (&p)[4], const S (&dp)[4], const S (&ddp)[4], S (&q)[4],
                                           S (&omega)[3], S (&alpha)[3]) {
  using std::sqrt;
  const S n = (p[0] * p[0] + p[1] * p[1]) + (p[2] * p[2] + p[3] * p[3]);
  const S along = (p[0] * dp[0] + p[1] * dp[1]) + (p[2] * dp[2] + p[3] * dp[3]);
  const S inverse = sqrt(n) / n;
  const S twice = 2 * (inverse * inverse);
  const S growth = twice * along;
  const S p0 = twice * p[0], p1 = twice * p[1], p2 = twice * p[2], p3 = twice * p[3];
  for (int i = 0; i < 4; ++i) q[i] = p[i] * inverse;
  omega[0] = (p3 * dp[0] - p0 * dp[3]) - (p1 * dp[2] - p2 * dp[1]);
  omega[1] = (p3 * dp[1] - p1 * dp[3]) - (p2 * dp[0] - p0 * dp[2]);
  omega[2] = (p3 * dp[2] - p2 * dp[3]) - (p0 * dp[1] - p1 * dp[0]);
  alpha[0] = (p3 * ddp[0] - p0 * ddp[3]) - (p1 * ddp[2] - p2 * ddp[1]) - growth * omega[0];
  alpha[1] = (p3 * ddp[1] - p1 * ddp[3]) - (p2 * ddp[0] - p0 * ddp[2]) - growth * omega[1];
  alpha[2] = (p3 * ddp[2] - p2 * ddp[3]) - (p0 * ddp[1] - p1 * ddp[0]) - growth * omega[2];
}

/// A rotation's quaternion with its derivatives: q' = ½ q ω, q'' = ½ q (α − ½|ω|²).
template <class S>
[[gnu::always_inline]] inline void quaternion_jet(const S* q, const S* omega, const S* alpha,
                                                  TimeJet<S> (&out)[4]) {
  const S quarter_square = 0.25f * ((omega[0] * omega[0] + omega[1] * omega[1]) + omega[2] * omega[2]);
  S w[3], a[3];
  for (int i = 0; i < 3; ++i) {
    w[i] = 0.5f * omega[i];
    a[i] = 0.5f * alpha[i];
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = {q[i], q[3] * w[i] + (q[j] * w[k] - q[k] * w[j]),
              (q[3] * a[i] + (q[j] * a[k] - q[k] * a[j])) - quarter_square * q[i]};
  }
  out[3] = {q[3], -((q[0] * w[0] + q[1] * w[1]) + q[2] * w[2]),
            -((q[0] * a[0] + q[1] * a[1]) + q[2] * a[2]) - quarter_square * q[3]};
}

/// Quaternion product.
template <class S>
[[gnu::always_inline]] inline void multiply(const S (&a)[4], const S (&b)[4], S (&out)[4]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = (a[3] * b[i] + a[i] * b[3]) + (a[j] * b[k] - a[k] * b[j]);
  }
  out[3] = a[3] * b[3] - ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]);
}

}  // namespace
}  // namespace sinew
