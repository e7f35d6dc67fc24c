// The pendulum, and what it tells feet to do.
#include "sinew/behaviour/balance_plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

constexpr double kFrequency = 3.14;  ///< 1/s

Sole square(double half, const Vec2& middle = Vec2::Zero()) {
  Sole sole;
  for (const double x : {-half, half})
    for (const double y : {-half, half}) sole.add(middle + Vec2(x, y));
  sole.close();
  return sole;
}

TEST(BalancePlan, PendulumIsTheSameInOneStepOrAThousand) {
  Pendulum once{{0.05, -0.02}, {0.3, 0.1}}, often = once;
  once.advance({0.01, 0}, kFrequency, 0.5);
  for (int n = 0; n < 1000; ++n) often.advance({0.01, 0}, kFrequency, 0.0005);
  EXPECT_LT((once.place - often.place).norm(), 1e-12);
  EXPECT_LT((once.velocity - often.velocity).norm(), 1e-11);
  EXPECT_LT((once.acceleration - kFrequency * kFrequency * (once.place - Vec2(0.01, 0))).norm(), 1e-12);
}

TEST(BalancePlan, PressingBringsBackWhatIsWithinTheSolesAndNothingElse) {
  // 75 kg, soles to 0.155 m ahead: 75 · 3.14 · 0.155 = 36.5 N·s are the most without a step.
  const BalanceLaw law;
  for (const double impulse : {10.0, 20.0, 30.0, 33.0, 37.0, 45.0}) {
    Pendulum body{{0, 0}, {impulse / 75, 0}};
    const Sole sole = square(0.155);
    for (int n = 0; n < 600; ++n)
      body.advance(press(body, kFrequency, Vec2::Zero(), sole, law), kFrequency, 1 / 60.0);
    if (impulse < 34)
      EXPECT_LT(body.place.norm() + body.velocity.norm(), 1e-3) << impulse;
    else
      EXPECT_GT(body.place.norm(), 1) << impulse;
  }
}

TEST(BalancePlan, AFootWhereTheCapturePointWillBeCatchesIt) {
  const BalanceLaw law;
  Pendulum body{{0, 0}, {0.9, 0}};
  const Sole stance = square(0.1);
  const Vec2 lands = capture_point_after(body.capture_point(kFrequency), kFrequency, law.step_time, stance);
  for (double t = 0; t < law.step_time; t += 0.001)
    body.advance(stance.nearest(body.capture_point(kFrequency), 0), kFrequency, 0.001);
  EXPECT_LT((body.capture_point(kFrequency) - lands).norm(), 0.01);
  const Sole landed = square(0.05, lands);
  for (int n = 0; n < 600; ++n)
    body.advance(press(body, kFrequency, lands, landed, law), kFrequency, 1 / 60.0);
  EXPECT_LT((body.place - lands).norm(), 1e-3);
}

TEST(BalancePlan, TheFootOnTheSideThatItFallsToOrTheHindOne) {
  const BalanceLaw law;
  Feet feet{{Vec2(0, 0.1), Vec2(0, -0.1)}, 0};
  EXPECT_EQ(stepping_foot(feet, {0, 0.3}, Vec2::Zero(), law), 0);
  EXPECT_EQ(stepping_foot(feet, {0, -0.3}, Vec2::Zero(), law), 1);
  feet.place[0].x() = 0.2;
  EXPECT_EQ(stepping_foot(feet, {0.5, 0}, Vec2::Zero(), law), 1);
  EXPECT_EQ(stepping_foot(feet, {-0.5, 0}, Vec2::Zero(), law), 0);
  // All turned by a quarter: the same.
  Feet turned{{Vec2(-0.1, 0.2), Vec2(0.1, 0)}, std::acos(0.0)};
  EXPECT_EQ(stepping_foot(turned, {0, 0.5}, Vec2::Zero(), law), 1);
  EXPECT_EQ(stepping_foot(turned, {-0.3, 0}, Vec2::Zero(), law), 0);
}

TEST(BalancePlan, LandsWithinReachAndOnItsOwnSide) {
  const BalanceLaw law;
  const Feet feet{{Vec2(0, 0.1), Vec2(0, -0.1)}, 0};
  const Vec2 far = within_reach(feet, 0, {3, 0.1}, law);
  EXPECT_NEAR((far - feet.place[1]).norm(), law.longest_step, 1e-12);
  EXPECT_GE(within_reach(feet, 0, {0.3, -0.4}, law).y(), feet.place[1].y() + law.apart - 1e-12);
  EXPECT_LE(within_reach(feet, 1, {0.3, 0.4}, law).y(), feet.place[0].y() - law.apart + 1e-12);
}

TEST(BalancePlan, MoreStepsReachFurtherButNotForEver) {
  const BalanceLaw law;
  EXPECT_FALSE(out_of_reach(0.3, kFrequency, 1, law));
  EXPECT_TRUE(out_of_reach(0.5, kFrequency, 1, law));
  EXPECT_FALSE(out_of_reach(0.5, kFrequency, 2, law));
  EXPECT_TRUE(out_of_reach(1.0, kFrequency, 100, law));
  EXPECT_TRUE(out_of_reach(0.01, kFrequency, 0, law));
}

}  // namespace
}  // namespace sinew
