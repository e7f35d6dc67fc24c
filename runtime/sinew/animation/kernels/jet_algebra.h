// Quaternions in R⁴ and their projection to rotations, on any scalar: float, double, packs. Internal linkage,
// as pack.h.
#pragma once

namespace sinew {
namespace {

/// What p / |p| and its first two derivatives are as a rotation, angular velocity and angular acceleration in
/// child axes (coefficients x y z w). The length of p and how it changes cancel:
///     ω = 2·Im(p̄ p')/n,  α = 2·Im(p̄ p'')/n − ω·2(p·p')/n,  n = p·p
template <class S>
[[gnu::always_inline]] inline void project(const S (&p)[4], const S (&dp)[4], const S (&ddp)[4], S (&q)[4],
                                           S (&omega)[3], S (&alpha)[3]) {
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

}  // namespace
}  // namespace sinew
