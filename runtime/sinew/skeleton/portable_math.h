// Sine, arctangent and others that have the same bits in float with every C library and on every processor.
#pragma once

#include <cmath>
#include <concepts>

namespace sinew::portable {

// Libraries' functions for float differ in the last bit from one to the next, and within one from processor
// to processor (with and without fused multiplication). Those for double do, too, but rounded to float their
// results part once in 10⁸ calls. Flights and falls take as long with them (`dynamics_bench`). In double they
// are the library's. Always inlined: files that are compiled for wider registers must leave no copy behind
// that others would be linked to.

template <std::floating_point T>
[[gnu::always_inline]] inline T sin(T x) {
  return static_cast<T>(std::sin(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T cos(T x) {
  return static_cast<T>(std::cos(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T atan2(T y, T x) {
  return static_cast<T>(std::atan2(double(y), double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T exp(T x) {
  return static_cast<T>(std::exp(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T cbrt(T x) {
  return static_cast<T>(std::cbrt(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T hypot(T x, T y) {
  return static_cast<T>(std::hypot(double(x), double(y)));
}

}  // namespace sinew::portable
