// A jet that an offset is added to or taken from, on any scalar. Internal linkage, as pack.h.
#pragma once

#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/rodrigues.h"
#include "sinew/animation/quintic_offset.h"

namespace sinew {
namespace {

constexpr int kOffsetPart =
    9;  ///< numbers of a rotation's offset, or of a translation's: value, rate, change

/// How far `a` is from `b`, both as rotations that move: b̄·a and its motion in child axes.
template <class S>
[[gnu::always_inline]] inline OffsetRotation<S> difference(const OffsetRotation<S>& a,
                                                           const OffsetRotation<S>& b) {
  OffsetRotation<S> d;
  const S inverse[4] = {-b.q[0], -b.q[1], -b.q[2], b.q[3]};
  multiply(inverse, a.q, d.q);
  S omega[3], alpha[3], turning[3];
  turn_back(d.q, b.omega, omega);
  turn_back(d.q, b.alpha, alpha);
  cross(omega, a.omega, turning);
  for (int i = 0; i < 3; ++i) {
    d.omega[i] = a.omega[i] - omega[i];
    d.alpha[i] = (a.alpha[i] - alpha[i]) - turning[i];
  }
  return d;
}

/// b, and then the offset d: b·d, with ω = d⁻¹ω_b + ω_d, α = d⁻¹α_b + α_d + (d⁻¹ω_b)×ω_d.
template <class S>
[[gnu::always_inline]] inline OffsetRotation<S> composition(const OffsetRotation<S>& b,
                                                            const OffsetRotation<S>& d) {
  OffsetRotation<S> a;
  multiply(b.q, d.q, a.q);
  S omega[3], alpha[3], turning[3];
  turn_back(d.q, b.omega, omega);
  turn_back(d.q, b.alpha, alpha);
  cross(omega, d.omega, turning);
  for (int i = 0; i < 3; ++i) {
    a.omega[i] = omega[i] + d.omega[i];
    a.alpha[i] = (alpha[i] + d.alpha[i]) + turning[i];
  }
  return a;
}

/// Three numbers of an offset that began with `start`: values, rates, accelerations.
template <class S>
[[gnu::always_inline]] inline void faded(const QuinticOffset<S>& fade, const S (&start)[kOffsetPart],
                                         S (&value)[3], S (&rate)[3], S (&acceleration)[3]) {
  for (int i = 0; i < 3; ++i) {
    const TimeJet<S> x = fade({start[i], start[3 + i], start[6 + i]});
    value[i] = x.value;
    rate[i] = x.rate;
    acceleration[i] = x.acceleration;
  }
}

}  // namespace
}  // namespace sinew
