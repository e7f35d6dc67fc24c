#include "sinew/behaviour/sole.h"

#include <gtest/gtest.h>

#include <random>

namespace sinew {
namespace {

TEST(Sole, IsTheHullOfWhatWasAdded) {
  Sole sole;
  for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(0.5, 0.2), Vec2(1, 1), Vec2(0, 1), Vec2(0.5, 0.9)})
    sole.add(p);
  sole.close();
  EXPECT_EQ(sole.corners().size(), 4u);
  EXPECT_NEAR(sole.depth({0.5, 0.5}), 0.5, 1e-12);
  EXPECT_NEAR(sole.depth({0.5, -0.25}), -0.25, 1e-12);
}

TEST(Sole, NearestPointIsInsideByItsMargin) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 200; ++n) {
    Sole sole;
    for (int k = 0; k < 12; ++k) sole.add({0.1 * normal(random), 0.1 * normal(random)});
    sole.close();
    const Vec2 wanted(0.3 * normal(random), 0.3 * normal(random)), at = sole.nearest(wanted, 0.01);
    EXPECT_GT(sole.depth(at), 0.01 - 1e-9);
    if (sole.depth(wanted) > 0.01) {
      EXPECT_EQ(at, wanted);
    }
    // No other point of the hull is nearer by more than its margin costs.
    const double distance = (sole.nearest(wanted, 0) - wanted).norm();
    for (const Vec2& c : sole.corners()) EXPECT_GE((c - wanted).norm() + 1e-12, distance);
  }
}

TEST(Sole, OfNothingOrOnePointIsThat) {
  Sole none;
  none.close();
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.nearest({1, 2}, 0.01), Vec2::Zero());
  Sole point;
  point.add({1, 1});
  point.close();
  EXPECT_EQ(point.nearest({3, 1}, 0.01), Vec2(1, 1));
  EXPECT_NEAR(point.depth({3, 1}), -2, 1e-12);
}

}  // namespace
}  // namespace sinew
