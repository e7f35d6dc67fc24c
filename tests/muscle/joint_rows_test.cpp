// Scalar energies of joints: consistent derivatives, exact limits, convexity.
#include "sinew/muscle/joint_rows.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

JointRow<double> kink(double minus, double plus) {
  JointRow<double> row;
  row.kind = RowKind::kKink;
  row.minus = minus;
  row.plus = plus;
  row.width = 0.01;
  return row;
}

JointRow<double> stiff(RowKind kind) {
  JointRow<double> row;
  row.kind = kind;
  row.stiffness = 700;
  return row;
}

/// Reaches its limits at −0.004 and 0.01.
JointRow<double> toned(double minus, double plus) {
  JointRow<double> row = kink(minus, plus);
  row.kind = RowKind::kTone;
  row.stiffness = 5000;
  return row;
}

std::vector<JointRow<double>> all_rows() {
  return {kink(30, 80),    kink(0, 50), kink(50, 0), stiff(RowKind::kSpring), stiff(RowKind::kOneSided),
          toned(50, 20.5), toned(50, 0)};
}

// Between the points at which the curvature jumps: 0 and ± the width.
constexpr double kPlaces[] = {-0.3, -0.0101, -0.0099, -0.004, -1e-4, 1e-4, 0.004, 0.0099, 0.0101, 0.3};

TEST(JointRow, SlopeAndCurvatureAreDerivativesOfEnergy) {
  constexpr double step = 1e-6;  // piecewise quadratic: central differences are exact up to rounding
  for (const JointRow<double>& row : all_rows())
    for (const double s : kPlaces) {
      EXPECT_NEAR((row.energy(s + step) - row.energy(s - step)) / (2 * step), row.slope(s), 1e-6);
      EXPECT_NEAR((row.slope(s + step) - row.slope(s - step)) / (2 * step), row.curvature(s), 1e-5);
    }
}

TEST(JointRow, EnergyAndSlopeAreContinuous) {
  for (const JointRow<double>& row : all_rows())
    for (const double s : {-0.01, 0.0, 0.01}) {
      EXPECT_NEAR(row.energy(s + 1e-12), row.energy(s - 1e-12), 1e-9);
      EXPECT_NEAR(row.slope(s + 1e-12), row.slope(s - 1e-12), 1e-6);
    }
}

TEST(JointRow, EnergyIsConvexAndNowhereNegative) {
  for (const JointRow<double>& row : all_rows())
    for (const double s : kPlaces) {
      EXPECT_GE(row.energy(s), 0);
      EXPECT_GE(row.curvature(s), 0);
    }
}

TEST(Muscle, PullsWithExactlyItsLimitOffTheTarget) {
  const JointRow<double> row = kink(30, 80);
  EXPECT_EQ(-row.slope(0.3), -30);  // beyond the target: pulled back by the negative side
  EXPECT_EQ(-row.slope(-0.3), 80);  // short of it: pulled on by the positive side
  EXPECT_EQ(row.slope(0), 0);
}

TEST(Muscle, WithAToneIsASpringUpToExactlyItsLimit) {
  const JointRow<double> row = toned(50, 20);
  EXPECT_EQ(row.slope(0), 0);
  EXPECT_EQ(row.slope(0.002), 10);
  EXPECT_EQ(row.slope(0.3), 50);
  EXPECT_EQ(row.slope(-0.3), -20);
  EXPECT_EQ(row.curvature(0.002), 5000);
  EXPECT_EQ(row.curvature(0.3), 0);
  // As steep as a kink over its width, it is the kink.
  JointRow<double> steep = toned(30, 30);
  steep.stiffness = 30 / 0.01;
  const JointRow<double> rigid = kink(30, 30);
  for (const double s : kPlaces) {
    EXPECT_DOUBLE_EQ(steep.energy(s), rigid.energy(s));
    EXPECT_DOUBLE_EQ(steep.slope(s), rigid.slope(s));
  }
}

TEST(JointLimit, DoesNothingWithinRange) {
  const JointRow<double> row = stiff(RowKind::kOneSided);
  EXPECT_EQ(row.energy(-0.1), 0);
  EXPECT_EQ(row.slope(-0.1), 0);
  EXPECT_EQ(row.curvature(-0.1), 0);
  EXPECT_EQ(row.slope(0.1), 70);
}

}  // namespace
}  // namespace sinew
