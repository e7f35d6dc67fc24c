// Modified Rodrigues parameters σ = axis · tan(angle / 4) of a rotation, with their derivatives, on any
// scalar: three numbers that add like a vector, are regular up to a whole turn and need no trigonometry.
// Internal linkage, as pack.h.
//
// Motion of a rotation b(σ) in its child axes, with s² = |σ|² and B(σ)·y = (1 − s²)y − 2σ×y + 2σ(σ·y):
//     ω = k·Bσ',  α = k·(Bσ'' + 2σ|σ'|²) − 4(σ·σ')/(1 + s²)·ω,  k = 4/(1 + s²)²
// and back, σ' = ¼·Bᵀω; Bᵀ/(1 + s²) turns vectors as b does.
// Schaub & Junkins, Analytical Mechanics of Space Systems, 3.5 (rates); α by differentiating them.
#pragma once

#include "sinew/skeleton/scalar.h"

namespace sinew {
namespace {

template <class S>
[[gnu::always_inline]] inline S dot(const S (&a)[3], const S (&b)[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}
template <class S>
[[gnu::always_inline]] inline void cross(const S (&a)[3], const S (&b)[3], S (&out)[3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = a[j] * b[k] - a[k] * b[j];
  }
}

/// A rotation as seen from the frame that it is an offset from, and how it moves: child axes.
template <class S>
struct OffsetRotation {
  S q[4];  ///< x y z w
  S omega[3], alpha[3];
};

/// (1 − s²)·y + 2·side·(σ×y) + 2σ(σ·y): Bᵀ for side 1, B for side −1.
template <class S>
[[gnu::always_inline]] inline void rodrigues_map(const S (&sigma)[3], const S& square, const S& side,
                                                 const S (&y)[3], S (&out)[3]) {
  S turned[3];
  cross(sigma, y, turned);
  const S along = dot(sigma, y), rest = S(1) - square, twice = along + along, both_sides = side + side;
  for (int i = 0; i < 3; ++i) out[i] = (rest * y[i] + both_sides * turned[i]) + twice * sigma[i];
}

template <class S>
[[gnu::always_inline]] inline OffsetRotation<S> rotation_of(const S (&sigma)[3], const S (&rate)[3],
                                                            const S (&acceleration)[3]) {
  OffsetRotation<S> b;
  const S square = dot(sigma, sigma), inverse = S(1) / (S(1) + square), twice = inverse + inverse;
  for (int i = 0; i < 3; ++i) b.q[i] = twice * sigma[i];
  b.q[3] = twice - S(1);
  const S k = twice * twice;
  const S speed = dot(rate, rate), growth = (twice + twice) * dot(sigma, rate), bend = speed + speed;
  S first[3], second[3];
  rodrigues_map(sigma, square, S(-1), rate, first);
  rodrigues_map(sigma, square, S(-1), acceleration, second);
  for (int i = 0; i < 3; ++i) {
    b.omega[i] = k * first[i];
    b.alpha[i] = k * (second[i] + bend * sigma[i]) - growth * b.omega[i];
  }
  return b;
}

/// The inverse of `rotation_of`, for the one of ±q that is less than half a turn.
template <class S>
[[gnu::always_inline]] inline void parameters_of(const OffsetRotation<S>& b, S (&sigma)[3], S (&rate)[3],
                                                 S (&acceleration)[3]) {
  const S sign = select(b.q[3] < S(0), S(-1), S(1));
  const S scale = sign / (S(1) + sign * b.q[3]);
  for (int i = 0; i < 3; ++i) sigma[i] = scale * b.q[i];
  const S square = dot(sigma, sigma), quarter = S(0.25);
  rodrigues_map(sigma, square, S(1), b.omega, rate);
  for (S& r : rate) r = quarter * r;
  // d/dt(Bᵀω) = Bᵀα − 2(σ·σ')ω + 2σ'×ω + 2σ'(σ·ω) + 2σ(σ'·ω)
  S turned[3];
  cross(rate, b.omega, turned);
  rodrigues_map(sigma, square, S(1), b.alpha, acceleration);
  const S along = dot(sigma, b.omega), across = dot(rate, b.omega), shrink = dot(sigma, rate);
  for (int i = 0; i < 3; ++i) {
    const S more = (turned[i] - shrink * b.omega[i]) + (along * rate[i] + across * sigma[i]);
    acceleration[i] = quarter * (acceleration[i] + (more + more));
  }
}

/// Inverse of the unit quaternion `q` (x y z w) times a vector: v − 2w(u×v) + 2u×(u×v) with u its vector
/// part.
template <class S>
[[gnu::always_inline]] inline void turn_back(const S (&q)[4], const S (&v)[3], S (&out)[3]) {
  const S axis[3] = {q[0] + q[0], q[1] + q[1], q[2] + q[2]};
  const S half[3] = {q[0], q[1], q[2]};
  S t[3], u[3];
  cross(axis, v, t);
  cross(half, t, u);
  for (int i = 0; i < 3; ++i) out[i] = (v[i] - q[3] * t[i]) + u[i];
}

}  // namespace
}  // namespace sinew
