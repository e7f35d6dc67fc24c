// Where on a clip something plays, as a motion.
#pragma once

#include "sinew/animation/time_jet.h"

namespace sinew {

/// Clip time τ (s), its rate τ' (1 at normal speed, negative backwards) and how the rate changes, τ'' (1/s):
/// what a clip gives is then exact while time itself is warped, α = τ'²·α_clip + τ''·ω_clip. A plain number
/// plays at normal speed.
struct ClipTime : TimeJet<double> {
  /// τ (s), τ', τ'' (1/s).
  ClipTime(double seconds = 0, double speed = 1, double change = 0)
      : TimeJet<double>(seconds, speed, change) {}
  /// The same as a jet.
  ClipTime(const TimeJet<double>& time) : TimeJet<double>(time) {}

  /// The same `h` seconds later: exact while τ'' stays as it is.
  ClipTime after(double h) const {
    return {value + rate * h + h * h / 2 * acceleration, rate + acceleration * h, acceleration};
  }
};

}  // namespace sinew
