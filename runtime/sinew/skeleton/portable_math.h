// Sine, arctangent and others that have the same bits with every C library and on every processor.
#pragma once

#include <cmath>
#include <concepts>

namespace sinew::portable {

// Libraries' functions differ in the last bit from one to the next, and within one from processor to
// processor (with and without fused multiplication). These are made of additions, products, quotients and
// roots, which IEEE 754 rounds alike everywhere: within 2 units in the last place of the true value (cbrt:
// 3), and as the library's where an argument or the result is infinite or NaN. Sines of angles beyond 10⁶ rad
// are those of an angle within its rounding. Flights and falls take as long with them (`dynamics_bench`).
double sin(double x);
double cos(double x);
double atan2(double y, double x);
double exp(double x);
double expm1(double x);
double cbrt(double x);
double hypot(double x, double y);  ///< 0 or infinite where the squares leave double's range

// In float: rounded from double. Always inlined: files that are compiled for wider registers must leave no
// copy behind that others would be linked to.
template <std::floating_point T>
[[gnu::always_inline]] inline T sin(T x) {
  return static_cast<T>(sin(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T cos(T x) {
  return static_cast<T>(cos(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T atan2(T y, T x) {
  return static_cast<T>(atan2(double(y), double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T exp(T x) {
  return static_cast<T>(exp(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T expm1(T x) {
  return static_cast<T>(expm1(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T cbrt(T x) {
  return static_cast<T>(cbrt(double(x)));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T hypot(T x, T y) {
  return static_cast<T>(hypot(double(x), double(y)));
}

}  // namespace sinew::portable
