// Limits without a kink: what bounds a motion keeps its velocity and acceleration continuous.
#pragma once

#include "sinew/animation/time_jet.h"

namespace sinew {

/// x above `width`, 0 below −width, and C² between the two: slope 3u² − 2u³. Never below either 0 or x, and
/// above them by 3/16 of `width` (> 0, in the unit of x) at most.
template <class T>
TimeJet<T> soft_positive(const TimeJet<T>& x, const T& width) {
  if (x.value >= width) return x;
  if (x.value <= -width) return TimeJet<T>(T(0));
  const T twice = 2 * width;
  const TimeJet<T> u = (T(1) / twice) * (x + TimeJet<T>(width));
  return twice * (u * u * u * (TimeJet<T>(T(1)) - T(0.5) * u));
}
/// The larger of two, C²: above it by 3/16 of `width` at most, where they are equal.
template <class T>
TimeJet<T> soft_max(const TimeJet<T>& a, const TimeJet<T>& b, const T& width) {
  return a + soft_positive<T>(b - a, width);
}
/// The smaller of two, C²: below it by as much at most.
template <class T>
TimeJet<T> soft_min(const TimeJet<T>& a, const TimeJet<T>& b, const T& width) {
  return a - soft_positive<T>(a - b, width);
}

/// x³(10 − 15x + 6x²) within 0 and 1, level beyond, C²: keeps a weight in its range without a kink.
template <class T>
TimeJet<T> soft_step(const TimeJet<T>& x) {
  if (x.value <= T(0)) return TimeJet<T>(T(0));
  if (x.value >= T(1)) return TimeJet<T>(T(1));
  return x * x * x * (TimeJet<T>(T(10)) - x * (TimeJet<T>(T(15)) - T(6) * x));
}

}  // namespace sinew
