// The shared limit of a ball joint's muscles: consistent derivatives, torques on the ellipsoid, convexity.
#include "sinew/muscle/ellipsoid_row.h"

#include <gtest/gtest.h>

#include <random>

namespace sinew {
namespace {

using V = Vec3<double>;

EllipsoidRow<double> lopsided() {
  EllipsoidRow<double> row;
  row.minus = {20, 35, 12};
  row.plus = {30, 50, 40};
  row.width = 0.01;
  return row;
}

/// Offsets inside the rounding and far outside, in all octants.
std::vector<V> places() {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<V> all;
  for (int n = 0; n < 60; ++n) {
    const V direction = V(normal(random), normal(random), normal(random)).normalized();
    all.push_back(direction * (n % 2 ? 0.3 : 0.002));
  }
  return all;
}

TEST(EllipsoidRow, SlopeAndCurvatureAreDerivativesOfEnergy) {
  const EllipsoidRow<double> row = lopsided();
  constexpr double step = 1e-6;  // truncation step²·ψ''' and rounding 1e-16·ψ/step are both below 1e-7
  for (const V& s : places())
    for (int k = 0; k < 3; ++k) {
      const V d = step * V::Unit(k);
      EXPECT_NEAR((row.energy(s + d) - row.energy(s - d)) / (2 * step), row.slope(s)[k], 1e-6);
      EXPECT_LT(((row.slope(s + d) - row.slope(s - d)) / (2 * step) - row.curvature(s).col(k)).norm(), 1e-4);
    }
}

TEST(EllipsoidRow, TorqueOffTheTargetLiesOnTheEllipsoidOfTheSidesThatPullBack) {
  const EllipsoidRow<double> row = lopsided();
  for (const V& s : places()) {
    double share = 0;
    for (int k = 0; k < 3; ++k)
      share += std::pow(row.slope(s)[k] / (s[k] > 0 ? row.minus[k] : row.plus[k]), 2);
    if (s.norm() > 0.1)
      EXPECT_NEAR(share, 1, 1e-12);
    else
      EXPECT_LT(share, 1);
    EXPECT_GT(row.slope(s).dot(s), 0) << "pulls back";
  }
}

TEST(EllipsoidRow, EqualLimitsPullStraightBackWithOneStrengthInEveryDirection) {
  EllipsoidRow<double> row;
  row.minus = row.plus = V::Constant(50);
  for (const V& s : places()) EXPECT_LT((row.slope(s) - 50 * s.normalized()).norm(), 1e-9);
}

TEST(EllipsoidRow, CurvatureIsNowhereNegative) {
  const EllipsoidRow<double> row = lopsided();
  for (const V& s : places())
    for (const V& d : places()) EXPECT_GE(d.dot(row.curvature(s) * d), -1e-12);
}

TEST(EllipsoidRow, MusclesWithoutStrengthPullNothing) {
  const EllipsoidRow<double> row;
  EXPECT_EQ(row.slope({0.1, 0, 0}), V(0, 0, 0));
  EXPECT_EQ(row.curvature({0.1, 0, 0}), Mat3<double>(Mat3<double>::Zero()));
}

}  // namespace
}  // namespace sinew
