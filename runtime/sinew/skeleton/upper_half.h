// Numbers to half their digits: for state that no result is sensitive to, which snapshots have to hold.
#pragma once

#include <cstdint>
#include <limits>

namespace sinew {

/// Binary digits of the lower half of a number's.
template <class T>
constexpr int kLowerDigits = (std::numeric_limits<T>::digits + 1) / 2;

/// A number to the upper half of its digits (Dekker, "A floating-point technique for extending the available
/// precision", 1971).
template <class T>
T upper_half(T x) {
  constexpr T kSplit = T((std::uint64_t(1) << kLowerDigits<T>)+1);
  const T larger = kSplit * x;
  return larger - (larger - x);
}

}  // namespace sinew
