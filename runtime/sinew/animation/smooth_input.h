// A game's inputs, which step, as motions that do not.
#pragma once

#include <cmath>

#include "sinew/animation/time_jet.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

/// Follows a goal with three equal poles: whatever the goal does between two frames, value, rate and
/// acceleration are continuous (C²), and from rest it never goes beyond the goal. Weights, speeds and targets
/// that come through it keep a blend's accelerations exact.
///
/// Exact for every h: one step of 250 ms ends where 250 steps of 1 ms end. Its whole state is one jet.
/// S is float, double or a pack of them; other quantities component by component.
template <class S>
struct SmoothInput {
  TimeJet<S> x{S(0)};  ///< where it is; set it to a constant to begin there at rest

  /// Moves `h` seconds on towards `goal`, which is taken as constant during them. `pole` (1/s, > 0): see
  /// `pole_of`.
  void step(const S& goal, const S& pole, const S& h) {
    using portable::exp;
    // Solution of (d/dt + y)³ e = 0 for e = x − goal: (j₀ + j₁ h + j₂ h²/2)·exp(−y h).
    const S e = x.value - goal, slope = x.rate + pole * e;
    const S bend = x.acceleration + pole * (x.rate + x.rate + pole * e);
    const S decay = exp(-(pole * h));
    const S left = (e + slope * h + bend * (h * h) / S(2)) * decay;
    const S rate = (slope + bend * h) * decay - pole * left;
    x.acceleration = bend * decay - pole * (rate + rate + pole * left);
    x.value = goal + left;
    x.rate = rate;
  }
  /// The pole for which half of a step of the goal is done `half_life` seconds later. Peak |x''| is then
  /// 0.231·pole² times the step: 1.65 / half_life².
  static constexpr S pole_of(const S& half_life) { return S(kPoleHalfLife) / half_life; }

 private:
  static constexpr double kPoleHalfLife = 2.6740603;  ///< root of exp(−x)·(1 + x + x²/2) = ½
};

}  // namespace sinew
