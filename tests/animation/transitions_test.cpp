// Filtered inputs, fading offsets and transitions, beyond what all nodes share (motion_nodes_test.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "animation/moving_pose.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/smooth_input.h"

namespace sinew {
namespace {

using fixtures::Pose;
using fixtures::sampled;

constexpr unsigned kSeed = 20261125;
constexpr int kJoints = 11;
constexpr double kPi = 3.14159265358979323846;

TEST(SmoothInput, IsHalfWayAfterItsHalfLifeAndNeverBeyondTheGoal) {
  SmoothInput<double> input;
  const double pole = SmoothInput<double>::pole_of(0.2);
  input.step(1, pole, 0.2);
  EXPECT_NEAR(input.x.value, 0.5, 1e-6);  // the constant has eight digits
  for (int n = 0; n < 1000; ++n) {
    input.step(1, pole, 0.005);
    ASSERT_LE(input.x.value, 1 + 1e-15);
  }
  EXPECT_NEAR(input.x.value, 1, 1e-12);
}

TEST(SmoothInput, PeakOfItsAccelerationIsAsDocumented) {
  SmoothInput<double> input;
  double peak = 0;
  for (int n = 0; n < 10000; ++n) {
    input.step(1, 10, 1e-4);
    peak = std::max(peak, std::abs(input.x.acceleration));
  }
  EXPECT_NEAR(peak, 0.231 * 100, 0.1);  // three digits documented
}

TEST(SmoothInput, OneStepIsManyEvenWhileTheGoalIsFarAway) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 100; ++n) {
    SmoothInput<double> once{{normal(random), 9 * normal(random), 90 * normal(random)}}, often = once;
    const double goal = 5 * normal(random);
    once.step(goal, 13, 0.25);
    for (int k = 0; k < 250; ++k) often.step(goal, 13, 0.001);
    EXPECT_NEAR(once.x.value, often.x.value, 1e-12) << "seed " << kSeed;
    EXPECT_NEAR(once.x.rate, often.x.rate, 1e-11);
    EXPECT_NEAR(once.x.acceleration, often.x.acceleration, 1e-10);
  }
}

TEST(QuinticOffset, BeginsAsToldEndsAtRestAndMovesAsItsDerivativesSay) {
  const TimeJet<double> start{0.7, -3, 40};
  const auto at = [&](double t) { return QuinticOffset<double>::at(t, 0.3)(start); };
  EXPECT_EQ(at(0).value, start.value);
  EXPECT_EQ(at(0).rate, start.rate);
  EXPECT_EQ(at(0).acceleration, start.acceleration);
  for (const double t : {0.3, 0.5}) {
    EXPECT_EQ(at(t).value, 0);
    EXPECT_EQ(at(t).rate, 0);
    EXPECT_EQ(at(t).acceleration, 0);
  }
  EXPECT_NEAR(at(0.3 - 1e-9).acceleration, 0, 1e-4);  // one nanosecond times a third derivative
  constexpr double h = 1e-5;
  for (double t = 0.01; t < 0.3; t += 0.017) {
    EXPECT_NEAR((at(t + h).value - at(t - h).value) / (2 * h), at(t).rate, 1e-5);
    EXPECT_NEAR((at(t + h).rate - at(t - h).rate) / (2 * h), at(t).acceleration, 1e-3);
  }
}

TEST(QuinticOffset, BoundsHoldForEveryStart) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 300; ++n) {
    const double T = 0.05 + std::abs(normal(random));
    const TimeJet<double> start{normal(random), 5 * normal(random), 50 * normal(random)};
    const double x0 = std::abs(start.value), v0 = std::abs(start.rate), a0 = std::abs(start.acceleration);
    for (double t = 0; t <= T; t += T / 200) {
      const TimeJet<double> x = QuinticOffset<double>::at(t, T)(start);
      ASSERT_LE(std::abs(x.value), x0 + 0.1985 * v0 * T + 0.01735 * a0 * T * T) << "seed " << kSeed;
      ASSERT_LE(std::abs(x.acceleration), 5.7745 * x0 / (T * T) + 3.9405 * v0 / T + a0 + 1e-12);
    }
  }
}

TEST(QuinticOffset, ShortestFadeKeepsWithinTheAccelerationThatItIsGiven) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 300; ++n) {
    const TimeJet<double> start{normal(random), 5 * normal(random), 0};
    const double allowed = 10 + 90 * std::abs(normal(random));
    const double T = shortest_fade(start.value, start.rate, allowed);
    for (double t = 0; t <= T; t += T / 200)
      ASSERT_LE(std::abs(QuinticOffset<double>::at(t, T)(start).acceleration), 1.001 * allowed);
  }
}

/// A character that changes clips.
struct Change {
  Clip from = fixtures::smooth_clip(1), to = fixtures::smooth_clip(2);
  std::vector<double> numbers = std::vector<double>(inertial_numbers(kJoints, kJoints));
  InertialState<double> state{numbers, kJoints, kJoints};

  Pose out(double t, const Clip& clip, double elapsed, std::span<const double> profile = {}) {
    Pose pose = sampled(clip, t);
    state.elapsed = elapsed;
    const Status status = InertializeJob<double>{pose, &state, profile, pose}.Run();
    EXPECT_TRUE(status.ok()) << status.reason;
    return pose;
  }
};

double distance(const JointJet<double>& a, const JointJet<double>& b, double t_of_alpha = 1) {
  const Quat<double> apart = a.rotation.conjugate() * b.rotation;
  return std::max({2 * apart.vec().norm(), (a.omega - b.omega).norm(),
                   t_of_alpha * (a.alpha - b.alpha).norm(), (a.translation - b.translation).norm(),
                   (a.velocity - b.velocity).norm(), (a.acceleration - b.acceleration).norm()});
}

TEST(Inertialize, BeginsExactlyAsTheOldMotionAndEndsWithTheBitsOfTheNew) {
  Change c;
  const Pose old = sampled(c.from, 0.7), next = sampled(c.to, 0.7);
  ASSERT_TRUE(begin_inertial<double>(old, next, 0.3, c.state).ok());
  const Pose first = c.out(0.7, c.to, 0);
  for (int j = 0; j < kJoints; ++j) EXPECT_LT(distance(first[j], old[j]), 1e-12) << j;  // rounding
  const Pose last = c.out(1.0, c.to, 0.3), wanted = sampled(c.to, 1.0);
  for (int j = 0; j < kJoints; ++j) fixtures::expect_same_bits(last[j], wanted[j]);
}

TEST(Inertialize, SixtyInterruptionsInSixtyFramesStayOnTheMotion) {
  Change c;
  const Clip* playing[] = {&c.to, &c.from};
  Pose now = sampled(c.from, 0);
  for (int n = 0; n < 60; ++n) {
    const double t = n / 60.0;
    ASSERT_TRUE(begin_inertial<double>(now, sampled(*playing[n % 2], t), 0.2, c.state).ok());
    const Pose here = c.out(t, *playing[n % 2], 0);
    for (int j = 0; j < kJoints; ++j)
      ASSERT_LT(distance(here[j], now[j]), 1e-9 * (1 + now[j].alpha.norm())) << "frame " << n;
    now = c.out(t + 1 / 60.0, *playing[n % 2], 1 / 60.0);
    for (const JointJet<double>& jet : now) ASSERT_LT(jet.omega.norm(), 50) << "frame " << n;
  }
}

TEST(Inertialize, NearlyHalfATurnBetweenTheMotionsIsNothingSpecial) {
  Change c;
  Pose old = sampled(c.from, 0.7);
  const Pose next = sampled(c.to, 0.7);
  for (int j = 0; j < kJoints; ++j)
    old[j].rotation = next[j].rotation * rotation_exp<double>(Vec3<double>(179.9 / 180 * kPi, 0, 0));
  ASSERT_TRUE(begin_inertial<double>(old, next, 0.4, c.state).ok());
  const Pose first = c.out(0.7, c.to, 0);
  for (int j = 0; j < kJoints; ++j)
    EXPECT_LT(distance(first[j], old[j]), 1e-10 * (1 + old[j].alpha.norm())) << j;
  fixtures::expect_consistent([&](double t) { return c.out(0.7 + t, c.to, t); }, {0.05, 0.2, 0.35}, 1e-3);
}

TEST(Inertialize, FewerJointsThanBeganAndAStoppedClockAreAllowed) {
  Change c;
  ASSERT_TRUE(begin_inertial<double>(sampled(c.from, 0.7), sampled(c.to, 0.7), 0.4, c.state).ok());
  const Pose all = c.out(0.8, c.to, 0.1);
  for (int joints = 1; joints < kJoints; ++joints) {
    Pose some = sampled(c.to, 0.8);
    some.resize(joints);
    ASSERT_TRUE((InertializeJob<double>{some, &c.state, {}, some}.Run().ok()));
    for (int j = 0; j < joints; ++j) fixtures::expect_same_bits(some[j], all[j]);
  }
  const Pose again = c.out(0.8, c.to, 0.1);
  for (int j = 0; j < kJoints; ++j) fixtures::expect_same_bits(again[j], all[j]);
}

TEST(Inertialize, ProfileEndsJointsEarlier) {
  Change c;
  ASSERT_TRUE(begin_inertial<double>(sampled(c.from, 0.7), sampled(c.to, 0.7), 0.4, c.state).ok());
  std::vector<double> profile(kJoints, 1);
  profile[3] = 0.5;
  const Pose late = c.out(0.91, c.to, 0.21, profile), wanted = sampled(c.to, 0.91);
  fixtures::expect_same_bits(late[3], wanted[3]);
  EXPECT_GT(distance(late[4], wanted[4]), 0.01);
}

TEST(Inertialize, TranslationsBeyondThoseAskedForAreTheNewMotions) {
  for (const int translated : {0, 1, 5}) {  // within a pack of joints, too
    Change c;
    c.state.translated = translated;
    ASSERT_TRUE(begin_inertial<double>(sampled(c.from, 0.7), sampled(c.to, 0.7), 0.4, c.state).ok());
    const Pose out = c.out(0.8, c.to, 0.1), wanted = sampled(c.to, 0.8);
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_EQ(out[j].translation == wanted[j].translation, j >= translated) << j << " of " << translated;
      EXPECT_EQ(out[j].acceleration == wanted[j].acceleration, j >= translated) << j << " of " << translated;
    }
  }
}

TEST(Inertialize, DurationKeepsJointsWithinWhatTheyCanSpare) {
  Change c;
  const Pose old = sampled(c.from, 0.7), next = sampled(c.to, 0.7);
  ASSERT_TRUE(begin_inertial<double>(old, next, 0, c.state).ok());
  std::vector<double> spare(kJoints, 1e9);
  EXPECT_EQ(inertial_duration<double>(c.state, spare), 0.08) << "strong enough for the shortest";
  spare[4] = 200;
  const double T = inertial_duration<double>(c.state, spare, 0.01, 10);
  spare[5] = 50;
  EXPECT_GT(inertial_duration<double>(c.state, spare, 0.01, 10), T);
  spare[5] = 1e-9;
  EXPECT_EQ(inertial_duration<double>(c.state, spare), 0.6) << "nothing to spare: the longest";
}

TEST(Inertialize, RefusesWhatCannotBeMeant) {
  Change c;
  Pose pose = sampled(c.to, 0.7);
  EXPECT_FALSE((InertializeJob<double>{pose, nullptr, {}, pose}.Run().ok()));
  EXPECT_FALSE(begin_inertial<double>(std::span(pose).first(3), pose, 0.3, c.state).ok());
  EXPECT_FALSE(begin_inertial<double>(pose, pose, -1, c.state).ok());
  EXPECT_EQ(begin_inertial<double>(pose, pose, NAN, c.state).code, Code::kNotFinite);
  c.state.elapsed = NAN;
  EXPECT_EQ((InertializeJob<double>{pose, &c.state, {}, pose}.Run().code), Code::kNotFinite);
  c.state.elapsed = 0;
  const std::vector<double> profile(kJoints, 0);
  EXPECT_EQ((InertializeJob<double>{pose, &c.state, profile, pose}.Run().code), Code::kOutOfRange);
  c.state.offsets = c.state.offsets.first(5);
  EXPECT_FALSE((InertializeJob<double>{pose, &c.state, {}, pose}.Run().ok()));
}

TEST(Extrapolate, BeginsAsTheMotionAndComesToRest) {
  const Pose from = sampled(fixtures::smooth_clip(1), 0.7);
  Pose out(kJoints);
  const auto at = [&](double t) {
    ExtrapolateJob<double> job;
    job.from = from;
    job.elapsed = t;
    job.out = out;
    EXPECT_TRUE(job.Run().ok());
    return out;
  };
  for (int j = 0; j < kJoints; ++j) EXPECT_LT(distance(at(0)[j], from[j]), 1e-12);
  const Pose late = at(5);
  for (int j = 0; j < kJoints; ++j) {
    EXPECT_LT(late[j].omega.norm(), 1e-12 * (1 + from[j].omega.norm()));
    // (v₀ + a₀/z) / y, the area below the rate, as four times the parameters' length
    const double turned =
        4 * std::tan(rotation_log<double>(from[j].rotation.conjugate() * late[j].rotation).norm() / 4);
    const double wanted = (from[j].omega * (1 / 7.0 + 1 / 120.0) + from[j].alpha / (7 * 120.0)).norm();
    EXPECT_NEAR(turned, wanted, 1e-9);
  }
  ExtrapolateJob<double> wrong{from, 0.1, 120, 7, out};
  EXPECT_EQ(wrong.Run().code, Code::kOutOfRange);
}

JointJet<double> turned_to(double degrees) {
  JointJet<double> jet;
  jet.rotation = rotation_exp<double>({0, 0, degrees * kPi / 180});
  return jet;
}

TEST(Hemisphere, ElbowsMoreThanHalfATurnApartBlendThroughRestWithoutAJump) {
  // Between +110 and −80 degrees the short way round is through the body.
  const Pose a = {turned_to(110)}, b = {turned_to(-80)};
  const std::vector<Transform<double>> rest(1);
  Pose out(1);
  double before = 110;
  for (const BlendMode mode : {BlendMode::kMix, BlendMode::kOverride}) {
    before = 110;
    for (double w = 0; w <= 1.0001; w += 0.001) {
      const double down = mode == BlendMode::kMix ? std::max(0.0, 1 - w) : 1;
      const BlendLayer<double> layers[] = {{a, {down, 0, 0}}, {b, {std::min(w, 1.0), 0, 0}, {}, mode}};
      ASSERT_TRUE((BlendingJob<double>{layers, rest, out}.Run().ok()));
      const double angle = 180 / kPi * rotation_log<double>(out[0].rotation).z();
      ASSERT_LE(angle, before + 1e-9) << "turns back at " << w;
      ASSERT_LT(before - angle, 3) << "jumps at " << w;  // 190 degrees in 1000 steps, tenfold in the middle
      before = angle;
    }
    EXPECT_NEAR(before, -80, 1e-6);
  }
}

TEST(Hemisphere, OrderOfMixedLayersMeansNothing) {
  const Pose a = sampled(fixtures::smooth_clip(1), 0.7), b = sampled(fixtures::smooth_clip(2), 0.7),
             c = sampled(fixtures::smooth_clip(3), 0.7);
  const std::vector<Transform<double>> rest(kJoints);
  Pose one(kJoints), two(kJoints);
  const BlendLayer<double> abc[] = {{a, {0.3, 1, 2}}, {b, {0.3, -1, 0}}, {c, {0.4, 0, 5}}};
  const BlendLayer<double> cab[] = {abc[2], abc[0], abc[1]};
  ASSERT_TRUE((BlendingJob<double>{abc, rest, one}.Run().ok()));
  ASSERT_TRUE((BlendingJob<double>{cab, rest, two}.Run().ok()));
  for (int j = 0; j < kJoints; ++j) EXPECT_LT(distance(one[j], two[j]), 1e-9) << j;
}

}  // namespace
}  // namespace sinew
