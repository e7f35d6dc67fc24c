#include "sinew/skeleton/portable_math.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace sinew::portable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.141592653589793, kPiRest = 1.2246467991473532e-16;  // of which double has no room

/// The coefficients of Σ xᵏ/k! for k = First, First + Step … Last. With a last term below the rounding of the
/// first no better polynomial is needed on the ranges here.
template <int First, int Step, int Last>
constexpr auto kTaylor = [] {
  std::array<double, (Last - First) / Step + 1> of{};
  double factorial = 1;
  for (int k = 1; k <= Last; ++k) {
    factorial *= k;
    if (k >= First && (k - First) % Step == 0) of[(k - First) / Step] = 1 / factorial;
  }
  return of;
}();

/// Horner's.
template <std::size_t N>
double polynomial(const std::array<double, N>& coefficients, double x) {
  double sum = coefficients[N - 1];
  for (int k = int(N) - 2; k >= 0; --k) sum = coefficients[k] + sum * x;
  return sum;
}

/// To the nearest whole number, for |x| < 2⁵¹.
double rounded(double x) {
  constexpr double kUnits = 6755399441055744.0;  // 1.5·2⁵²: a double that large has no fraction
  return (x + kUnits) - kUnits;
}

/// Of x and so many quarters of a turn more (0: the sine, 1: the cosine), from the quarter nearest to x.
double sine(double x, int quarters) {
  // Parts of π/2 with 33 bits each but the last: products with the first two by whole numbers below 2²⁰ are
  // exact.
  constexpr double kPart[3] = {1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21};
  if (!(std::abs(x) < 1e6)) x = std::remainder(x, 2 * kPi);
  if (std::isnan(x)) return x;
  const double nearest = rounded(x * (2 / kPi));
  const double rest = ((x - nearest * kPart[0]) - nearest * kPart[1]) - nearest * kPart[2];
  const int quarter = (static_cast<int>(nearest) + quarters) & 3;
  const double square = rest * rest;
  double value = 0;
  if ((quarter & 1) != 0) {
    const double half = square / 2, first = 1 - half;
    value = first + (((1 - first) - half) + square * square * polynomial(kTaylor<4, 2, 16>, -square));
  } else {
    value = rest - rest * square * polynomial(kTaylor<3, 2, 15>, -square);
  }
  return (quarter & 2) != 0 ? -value : value;
}

/// Of 0 ≤ n ≤ d, d finite and > 0: the nearest eighth's arctangent and the rest by its series, from
/// tan(a − b) = (tan a − tan b)/(1 + tan a tan b).
double arctangent(double n, double d) {
  constexpr double kEighths[] = {0,
                                 0.12435499454676144,
                                 0.24497866312686414,
                                 0.35877067027057225,
                                 0.4636476090008061,
                                 0.5585993153435624,
                                 0.6435011087932844,
                                 0.7188299996216245,
                                 0.7853981633974483};
  const int eighth = static_cast<int>(rounded(8 * (n / d)));
  const double tangent = eighth / 8.0;
  const double rest = (n - tangent * d) / (d + tangent * n), square = rest * rest;
  constexpr std::array<double, 7> kOdd = {1. / 3, 1. / 5, 1. / 7, 1. / 9, 1. / 11, 1. / 13, 1. / 15};
  return kEighths[eighth] + (rest - rest * square * polynomial(kOdd, -square));
}

}  // namespace

double sin(double x) {
  return x == 0 ? x : sine(x, 0);
}
double cos(double x) {
  return sine(x, 1);
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return x + y;
  double n = std::abs(y), d = std::abs(x);
  const bool steep = n > d;
  if (steep) std::swap(n, d);
  if (d == kInfinity) {
    n = n == kInfinity ? 1 : 0;
    d = 1;
  }
  double angle = n == 0 ? 0 : arctangent(n, d);
  if (steep) angle = kPi / 2 - (angle - kPiRest / 2);
  if (std::signbit(x)) angle = kPi - (angle - kPiRest);
  return std::copysign(angle, y);
}

double exp(double x) {
  if (!(std::abs(x) < 1000)) return std::isnan(x) ? x : x < 0 ? 0 : kInfinity;
  // ln 2 in two parts, of which the first has 32 bits
  const double power = rounded(x * 1.4426950408889634);
  const double rest = (x - power * 0.6931471803691238) - power * 1.9082149292705877e-10;
  const double value = 1 + (rest + rest * rest * polynomial(kTaylor<2, 1, 14>, rest));
  const auto exponent = static_cast<int>(power);
  if (std::abs(exponent) > 1000) return std::ldexp(value, exponent);
  const std::uint64_t bits = std::uint64_t(1023 + exponent) << 52;
  double scale = 0;
  std::memcpy(&scale, &bits, sizeof scale);
  return value * scale;
}

double expm1(double x) {
  return std::abs(x) < 0.5 ? x + x * x * polynomial(kTaylor<2, 1, 17>, x) : exp(x) - 1;
}

double cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  int exponent = 0;
  double fraction = std::frexp(std::abs(x), &exponent);
  const int beyond = ((exponent % 3) + 3) % 3;  // fraction: 1/2 to 4
  fraction = std::ldexp(fraction, beyond);
  double root = 0.7 + 0.25 * fraction;
  for (int pass = 0; pass < 3; ++pass) {  // Halley's
    const double cube = root * root * root;
    root -= root * ((cube - fraction) / (2 * cube + fraction));
  }
  return std::copysign(std::ldexp(root, (exponent - beyond) / 3), x);
}

double hypot(double x, double y) {
  return std::sqrt(x * x + y * y);
}

}  // namespace sinew::portable
