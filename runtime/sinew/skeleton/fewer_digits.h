// Numbers to fewer digits: for state that no result is sensitive to, which snapshots have to hold.
#pragma once

#include <cstdint>
#include <limits>

namespace sinew {

/// Of a number's binary digits: a sixth and a half.
template <class T>
constexpr int kSixthOfDigits = std::numeric_limits<T>::digits / 6;
template <class T>
constexpr int kHalfOfDigits = (std::numeric_limits<T>::digits + 1) / 2;

/// A number without its last `dropped` digits, rounded (Dekker, "A floating-point technique for extending the
/// available precision", 1971).
template <int dropped, class T>
T rounded_off(T x) {
  constexpr T kSplit = T((std::uint64_t(1) << dropped) + 1);
  const T larger = kSplit * x;
  return larger - (larger - x);
}

}  // namespace sinew
