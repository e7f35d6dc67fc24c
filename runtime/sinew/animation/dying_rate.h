// How a motion goes on without its source: the law of ExtrapolateJob, for joints and for single numbers.
#pragma once

#include <cmath>

#include "sinew/animation/time_jet.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

/// What a unit of the rate and of the acceleration at the start have become: displacement, rate,
/// acceleration. Rates die away with `slowing` y, accelerations with `loss` z > y (1/s):
///
///     v(t) = v₀·e^(−yt) + (a₀ + y·v₀)·(e^(−yt) − e^(−zt))/(z − y)
template <class T>
struct DyingRate {
  T of_rate[3], of_acceleration[3];

  static DyingRate at(T elapsed, T slowing, T loss) {
    const T y = slowing, z = loss, slow = portable::exp(-y * elapsed), fast = portable::exp(-z * elapsed);
    const T gone_slow = -portable::expm1(-y * elapsed) / y, gone_fast = -portable::expm1(-z * elapsed) / z;
    const T lag[3] = {(gone_slow - gone_fast) / (z - y), (slow - fast) / (z - y),
                      (z * fast - y * slow) / (z - y)};
    return {{gone_slow + y * lag[0], slow + y * lag[1], y * lag[2] - y * slow}, {lag[0], lag[1], lag[2]}};
  }
  /// Where one that began as `start` is now.
  TimeJet<T> operator()(const TimeJet<T>& start) const {
    const auto sum = [&](int k) { return start.rate * of_rate[k] + start.acceleration * of_acceleration[k]; };
    return {start.value + sum(0), sum(1), sum(2)};
  }
};

}  // namespace sinew
