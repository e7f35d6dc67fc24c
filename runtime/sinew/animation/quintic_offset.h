// Offsets that fade: what takes a motion from where it was to where it is wanted.
#pragma once

#include <cmath>

#include "sinew/animation/time_jet.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// The quintic polynomial that begins with a given value, rate and acceleration and comes to rest at 0 when
/// `duration` is over. Added to a motion, it hides a jump of that motion entirely: C² at both ends. With
/// u = t/T and r = 1 − u:
///
///     x = x₀·r³(1 + 3u + 6u²) + v₀T·u·r³(1 + 3u) + ½a₀T²·u²r³
///     |x| ≤ |x₀| + 0.198 |v₀|T + 0.0173 |a₀|T²,  |x''| ≤ 5.774 |x₀|/T² + 3.940 |v₀|/T + |a₀|
///
/// Holds what a unit of each gives at an instant; all components of an offset share it.
template <class S>
struct QuinticOffset {
  TimeJet<S> of_value, of_rate, of_acceleration;  ///< of 1 at the start each

  /// Times in seconds. Zero from `duration` on, and for a duration of 0.
  static QuinticOffset at(const S& elapsed, const S& duration) {
    const S zero = S(0), one = S(1);
    const auto over = !(elapsed < duration);
    const S inverse = one / select(over, one, duration);
    const S u = select(over, one, largest(elapsed, zero) * inverse), r = one - u;
    const S u2 = u * u, r2 = r * r, r3 = r2 * r, ur = u * r;
    const S three = S(3) * u;
    QuinticOffset q;
    q.of_value = {r3 * (one + three + S(6) * u2), S(-30) * (ur * ur) * inverse,
                  S(-60) * ur * (r - u) * (inverse * inverse)};
    q.of_rate = {duration * (u * r3 * (one + three)), r2 * (one + (u + u) - S(15) * u2),
                 S(-12) * ur * (S(3) - S(5) * u) * inverse};
    q.of_acceleration = {duration * duration * (S(0.5) * (u2 * r3)), duration * (ur * r * (one - S(2.5) * u)),
                         r * (one - S(8) * u + S(10) * u2)};
    return q;
  }
  /// The offset now of one that began as `start`.
  TimeJet<S> operator()(const TimeJet<S>& start) const {
    const auto sum = [&](const S& a, const S& b, const S& c) {
      return (start.value * a + start.rate * b) + start.acceleration * c;
    };
    return {sum(of_value.value, of_rate.value, of_acceleration.value),
            sum(of_value.rate, of_rate.rate, of_acceleration.rate),
            sum(of_value.acceleration, of_rate.acceleration, of_acceleration.acceleration)};
  }
};

/// Shortest duration (s) in which an offset of |x₀| at a rate of |v₀| fades without adding more than
/// `acceleration` (> 0) to the |a₀| that it begins with: the larger root of
/// A·T² − 3.940 |v₀|·T − 5.774 |x₀| = 0, the bound above.
template <class S>
S shortest_fade(const S& offset, const S& rate, const S& acceleration) {
  using std::abs, std::sqrt;
  const S v = S(3.940) * abs(rate);
  return (v + sqrt(v * v + S(23.096) * acceleration * abs(offset))) / (acceleration + acceleration);
}

}  // namespace sinew
