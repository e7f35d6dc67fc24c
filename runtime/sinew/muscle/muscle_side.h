// Which of a muscle's two limits a torque meets.
#pragma once

#include "sinew/skeleton/scalar.h"

namespace sinew {

/// `plus` where the torque is ≥ 0, else `minus`: limits, or their inverses. T may be a pack.
template <class T>
T on_side(const T& torque, const T& minus, const T& plus) {
  return select(torque >= T(0), plus, minus);
}

}  // namespace sinew
