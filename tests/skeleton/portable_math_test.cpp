// Judged by the C library's, which differ from each other in the last bit.
#include "sinew/skeleton/portable_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace sinew {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// How many doubles apart.
double units(double a, double b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  return std::abs(a - b) / (std::nextafter(std::abs(b), kInfinity) - std::abs(b));
}

TEST(PortableMath, IsWithinThreeUnitsOfTheLibrary) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto of_any_size = [&](double least, double most) {
    return std::exp2(least + (most - least) * std::abs(uniform(random))) * (uniform(random) < 0 ? -1 : 1);
  };
  for (int n = 0; n < 300000; ++n) {
    const double x = of_any_size(-30, 16), y = of_any_size(-30, 16), e = 700 * uniform(random);
    ASSERT_LE(units(portable::sin(x), std::sin(x)), 3) << x;
    ASSERT_LE(units(portable::cos(x), std::cos(x)), 3) << x;
    ASSERT_LE(units(portable::atan2(y, x), std::atan2(y, x)), 3) << y << ' ' << x;
    ASSERT_LE(units(portable::exp(e), std::exp(e)), 3) << e;
    ASSERT_LE(units(portable::expm1(e / 700), std::expm1(e / 700)), 3) << e / 700;
    ASSERT_LE(units(portable::cbrt(x), std::cbrt(x)), 4) << x;
    ASSERT_LE(units(portable::hypot(x, y), std::hypot(x, y)), 3) << x << ' ' << y;
  }
}

TEST(PortableMath, FloatsAreTheNearest) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> uniform(-4, 4);
  for (int n = 0; n < 300000; ++n) {
    const float x = uniform(random), y = uniform(random);
    ASSERT_EQ(portable::sin(x), float(std::sin(double(x)))) << x;
    ASSERT_EQ(portable::cos(x), float(std::cos(double(x)))) << x;
    ASSERT_EQ(portable::atan2(y, x), float(std::atan2(double(y), double(x)))) << y << ' ' << x;
    ASSERT_EQ(portable::exp(x), float(std::exp(double(x)))) << x;
    ASSERT_EQ(portable::cbrt(x), float(std::cbrt(double(x)))) << x;
  }
}

TEST(PortableMath, EdgesAreTheLibrarys) {
  const double edges[] = {0.0,  -0.0,  1.0,    -1.0,      1e-320,     -1e-310, 710,
                          -746, 1e300, -1e300, kInfinity, -kInfinity, kNan};
  for (const double x : edges) {
    for (const double y : edges) {
      const double ours = portable::atan2(y, x), library = std::atan2(y, x);
      EXPECT_LE(units(ours, library), 2) << y << ' ' << x;
      EXPECT_TRUE(std::isnan(library) || std::signbit(ours) == std::signbit(library)) << y << ' ' << x;
    }
    EXPECT_LE(units(portable::exp(x), std::exp(x)), 2) << x;
    EXPECT_LE(units(portable::expm1(x), std::expm1(x)), 2) << x;
    EXPECT_LE(units(portable::cbrt(x), std::cbrt(x)), 4) << x;
    if (std::abs(x) < 1e6 || !std::isfinite(x)) {
      EXPECT_LE(units(portable::sin(x), std::sin(x)), 2) << x;
      EXPECT_LE(units(portable::cos(x), std::cos(x)), 2) << x;
    } else {
      EXPECT_NEAR(portable::sin(x) * portable::sin(x) + portable::cos(x) * portable::cos(x), 1, 1e-15) << x;
    }
  }
  // Next to multiples of a right angle, where digits cancel.
  for (int k = 1; k < 100000; k += 7) {
    const double angle = k * 1.5707963267948966;
    EXPECT_NEAR(portable::sin(angle), std::sin(angle), 2e-16) << k;
    EXPECT_NEAR(portable::cos(angle), std::cos(angle), 2e-16) << k;
  }
}

TEST(PortableMath, HasTheseBitsOnEveryMachine) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double x) { hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3u; };
  for (int n = -2000; n < 2000; ++n) {
    const double x = n / 64.0 + 1.0 / 3;
    for (const double value : {portable::sin(x), portable::cos(x), portable::atan2(x, 1.7), portable::exp(x),
                               portable::expm1(x), portable::cbrt(x), portable::hypot(x, 0.3)})
      add(value);
  }
  EXPECT_EQ(hash, 0xc93ce96ef165cab7u);
}

}  // namespace
}  // namespace sinew
