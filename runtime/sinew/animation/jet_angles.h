// Angles of motions: sines, cosines and arc tangents with their derivatives.
#pragma once

#include <cmath>

#include "sinew/animation/time_jet.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

/// Of an angle in rad.
template <class T>
TimeJet<T> sine(const TimeJet<T>& a) {
  const T s = portable::sin(a.value), c = portable::cos(a.value);
  return {s, c * a.rate, c * a.acceleration - s * a.rate * a.rate};
}
/// Of an angle in rad.
template <class T>
TimeJet<T> cosine(const TimeJet<T>& a) {
  const T s = portable::sin(a.value), c = portable::cos(a.value);
  return {c, -s * a.rate, -s * a.acceleration - c * a.rate * a.rate};
}
/// Angle of (x, y) from the x axis, rad, its value in (−π, π]. Not both 0.
template <class T>
TimeJet<T> angle_of(const TimeJet<T>& x, const TimeJet<T>& y) {
  const T square = x.value * x.value + y.value * y.value;
  const T growth = 2 * (x.value * x.rate + y.value * y.rate);
  const T rate = (x.value * y.rate - y.value * x.rate) / square;
  const T turn = x.value * y.acceleration - y.value * x.acceleration;
  return {portable::atan2(y.value, x.value), rate, (turn - rate * growth) / square};
}

}  // namespace sinew
