// Sine, arctangent and others that have the same bits in float with every C library and on every processor.
#pragma once

#include <cmath>

namespace sinew::portable {

// Libraries' functions for float differ in the last bit from one to the next, and within one from processor
// to processor (with and without fused multiplication). Those for double do, too, but rounded to float their
// results part once in 10⁸ calls. Flights and falls take as long with them (`dynamics_bench`). In double they
// are the library's. Always inlined: files that are compiled for wider registers must leave no copy behind
// that others would be linked to.
#define SINEW_PORTABLE [[gnu::always_inline]] inline

SINEW_PORTABLE float sin(float x) {
  return static_cast<float>(std::sin(double(x)));
}
SINEW_PORTABLE float cos(float x) {
  return static_cast<float>(std::cos(double(x)));
}
SINEW_PORTABLE float acos(float x) {
  return static_cast<float>(std::acos(double(x)));
}
SINEW_PORTABLE float atan2(float y, float x) {
  return static_cast<float>(std::atan2(double(y), double(x)));
}
SINEW_PORTABLE float exp(float x) {
  return static_cast<float>(std::exp(double(x)));
}
SINEW_PORTABLE float cbrt(float x) {
  return static_cast<float>(std::cbrt(double(x)));
}
SINEW_PORTABLE float hypot(float x, float y) {
  return static_cast<float>(std::sqrt(double(x) * double(x) + double(y) * double(y)));
}

SINEW_PORTABLE double sin(double x) {
  return std::sin(x);
}
SINEW_PORTABLE double cos(double x) {
  return std::cos(x);
}
SINEW_PORTABLE double acos(double x) {
  return std::acos(x);
}
SINEW_PORTABLE double atan2(double y, double x) {
  return std::atan2(y, x);
}
SINEW_PORTABLE double exp(double x) {
  return std::exp(x);
}
SINEW_PORTABLE double cbrt(double x) {
  return std::cbrt(x);
}
SINEW_PORTABLE double hypot(double x, double y) {
  return std::hypot(x, y);
}

#undef SINEW_PORTABLE

}  // namespace sinew::portable
