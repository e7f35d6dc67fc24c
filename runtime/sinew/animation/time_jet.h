// A quantity with its first two time derivatives, as a scalar: what is computed from motions is a motion.
#pragma once

#include <cmath>

namespace sinew {

/// value, d/dt, d²/dt². Arithmetic follows the product and chain rules exactly, so a formula written once on
/// a scalar gives positions, velocities and accelerations alike: Vec3<TimeJet<float>> is a moving point.
/// S is float, double, or a pack of them. Comparisons look at the value. Like a scalar, it begins
/// uninitialised.
template <class S>
struct TimeJet {
  S value;         ///< the quantity itself
  S rate;          ///< its first time derivative
  S acceleration;  ///< its second time derivative

  TimeJet() = default;
  /// What does not change.
  TimeJet(const S& constant) : value(constant), rate(S()), acceleration(S()) {}
  /// Value, rate, acceleration.
  TimeJet(const S& p, const S& dp, const S& ddp) : value(p), rate(dp), acceleration(ddp) {}

  // Arithmetic, by the rules above.
  /// @cond
  TimeJet& operator+=(const TimeJet& b) { return *this = *this + b; }
  TimeJet& operator-=(const TimeJet& b) { return *this = *this - b; }
  TimeJet& operator*=(const TimeJet& b) { return *this = *this * b; }
  TimeJet& operator/=(const TimeJet& b) { return *this = *this / b; }
  friend TimeJet operator+(const TimeJet& a, const TimeJet& b) {
    return {a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration};
  }
  friend TimeJet operator-(const TimeJet& a, const TimeJet& b) {
    return {a.value - b.value, a.rate - b.rate, a.acceleration - b.acceleration};
  }
  friend TimeJet operator-(const TimeJet& a) { return {-a.value, -a.rate, -a.acceleration}; }
  friend TimeJet operator*(const TimeJet& a, const TimeJet& b) {
    const S cross = a.rate * b.rate;
    return {a.value * b.value, a.value * b.rate + a.rate * b.value,
            (a.value * b.acceleration + a.acceleration * b.value) + (cross + cross)};
  }
  friend TimeJet operator*(const S& s, const TimeJet& a) {
    return {s * a.value, s * a.rate, s * a.acceleration};
  }
  friend TimeJet operator/(const TimeJet& a, const TimeJet& b) {
    const S ratio = a.value / b.value;
    const S slope = (a.rate - ratio * b.rate) / b.value;
    const S cross = slope * b.rate;
    return {ratio, slope, (a.acceleration - (cross + cross) - ratio * b.acceleration) / b.value};
  }
  friend TimeJet sqrt(const TimeJet& a) {
    using std::sqrt;
    const S root = sqrt(a.value), twice = root + root;
    const S slope = a.rate / twice;
    const S square = slope * slope;
    return {root, slope, (a.acceleration - (square + square)) / twice};
  }
  friend bool operator<(const TimeJet& a, const TimeJet& b) { return a.value < b.value; }
  friend bool operator>(const TimeJet& a, const TimeJet& b) { return a.value > b.value; }
  /// @endcond
};

}  // namespace sinew
