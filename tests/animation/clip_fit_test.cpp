// What the converter's fit promises: errors along the chain, accelerations, knots in seconds.
#include "convert/fit/clip_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "convert/fit/chain_error.h"
#include "sinew/animation/clip_packing.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kChain = 6;

/// A chain of six joints, 0.3 m from each to the next, in smooth motion of up to 3 Hz; the last is still.
Transform<double> truth(int joint, double t) {
  if (joint == kChain - 1) return {rotation_exp<double>({0.2, 0, 0}), {0, 0, 0.3}};
  const double a = 2 * kPi * t, phase = joint;
  const Vec3<double> turn(0.3 * std::sin(a + phase), 0.2 * std::cos(2 * a + phase),
                          0.02 * std::sin(3 * a + phase));
  return {rotation_exp<double>(turn), {joint == 0 ? 0.1 * std::sin(a) : 0, 0, joint == 0 ? 1 : 0.3}};
}

FitInput sampled(double rate, double seconds, bool loops) {
  FitInput input{"chain", loops, rate, {}};
  const int frames = static_cast<int>(std::lround(rate * seconds)) + 1;
  for (int f = 0; f < frames; ++f) {
    auto& pose = input.samples.emplace_back();
    for (int j = 0; j < kChain; ++j) pose.push_back(truth(j, f / rate));
  }
  for (int j = 0; j < kChain; ++j) {
    input.parents.push_back(j - 1);
    input.rest.push_back(truth(kChain - 1, 0).cast<float>());
  }
  return input;
}

std::size_t packed_bytes(const Clip& clip) {
  std::size_t sum = 0;
  for (const Clip::Group& group : clip.groups) {
    std::vector<std::uint8_t> bytes;
    EXPECT_TRUE(pack_group(group, bytes));
    sum += bytes.size();
  }
  return sum;
}

TEST(ChainError, IsThatOfAllAncestors) {
  const FitInput input = sampled(30, 1, false);
  ChainError chain(input.samples, input.parents, 0.1);
  EXPECT_EQ(chain.largest(), 0);
  JointMotion turned;
  for (const auto& pose : input.samples)
    turned.push_back({pose[1].rotation * rotation_exp<double>({0.001, 0, 0}), pose[1].translation});
  chain.set(1, turned);
  chain.update(1);
  EXPECT_EQ(chain.error(0, 5), 0);
  EXPECT_NEAR(chain.error(1, 5), 0.001 * 0.1, 1e-8);  // its own point, 10 cm away, moves on a small arc
  for (int j = 2; j < kChain; ++j) {
    const Vec3<double> arm = (chain.model(1, 5).inverse() * chain.model(j, 5)).translation;
    const double lever = Vec3<double>(0, arm.y(), arm.z()).norm();  // from the axis that it was turned about
    EXPECT_GT(chain.error(j, 5), 0.001 * (lever - 0.1));
    EXPECT_LT(chain.error(j, 5), 0.001 * (lever + 0.1));
  }
}

TEST(ClipFit, KeepsTheErrorAlongTheChainForEveryBudget) {
  for (const bool loops : {false, true})
    for (const double budget : {0.1, 1.0, 10.0}) {
      FitReport report;
      FitOptions options;
      options.max_error_mm = budget;
      const Clip clip = fit_clip(sampled(30, 3, loops), options, report);
      EXPECT_TRUE(validate(clip).ok());
      EXPECT_LE(report.max_mm, budget * (1 + 1e-4)) << loops;  // floats of the clip's duration
      EXPECT_GT(report.max_mm, 0.05 * budget) << loops;        // and uses what it is given
    }
}

TEST(ClipFit, WhatIsStillIsRestAndHasNoTrack) {
  FitReport report;
  const FitInput input = sampled(30, 3, false);
  const Clip clip = fit_clip(input, {}, report);
  for (const Clip::Group& group : clip.groups)
    for (const Clip::Track& track : group.tracks) {
      EXPECT_NE(track.joint, kChain - 1);
      EXPECT_TRUE(group.rotation || track.joint == 0);
    }
  EXPECT_EQ(clip.constants[kChain - 1], input.rest[kChain - 1]);
}

/// Knots are spaced in seconds: four times the samples of a smooth motion are no more information. A fifth
/// is left for the ladder of spacings, which goes by twos from the rate of the samples.
TEST(ClipFit, SamplesAtAHigherRateTakeNoMoreBytes) {
  FitReport report;
  const std::size_t at_30 = packed_bytes(fit_clip(sampled(30, 8, false), {}, report));
  const std::size_t at_120 = packed_bytes(fit_clip(sampled(120, 8, false), {}, report));
  EXPECT_LT(double(at_120), 1.2 * double(at_30));
}

/// Against the motion's own accelerations, by differences of the fourth order: knots and rounding may change
/// them by the budget each, root mean square.
TEST(ClipFit, KeepsAccelerations) {
  FitReport report;
  const FitOptions options;
  const Clip clip = fit_clip(sampled(60, 4, true), options, report);
  std::vector<JointJet<double>> jets(kChain);
  double squares[kChain] = {}, own[kChain] = {};
  int count = 0;
  constexpr double h = 1e-3;
  for (double t = 0.1; t < 3.9; t += 0.0137, ++count) {
    ASSERT_TRUE((SamplingJob<double>{&clip, t, jets}.Run().ok()));
    for (int j = 0; j < kChain; ++j) {
      const auto turned = [&](double by) {
        return rotation_log<double>(truth(j, t).rotation.conjugate() * truth(j, t + by).rotation);
      };
      const Vec3<double> alpha =
          (-turned(2 * h) + 16 * turned(h) + 16 * turned(-h) - turned(-2 * h)) / (12 * h * h);
      squares[j] += (jets[j].alpha - alpha).squaredNorm();
      own[j] += alpha.squaredNorm();
    }
  }
  for (int j = 0; j < kChain; ++j) {
    const double budget =
        std::max(options.angular_acceleration, options.acceleration_share * std::sqrt(own[j] / count));
    EXPECT_LT(std::sqrt(squares[j] / count), 2 * budget) << j;
  }
}

/// A root that turns round and round leaves the reach of three numbers beside a reference.
TEST(ClipFit, WholeTurnsAreKept) {
  FitInput input{"turn", false, 30, {}};
  for (int f = 0; f <= 90; ++f)
    input.samples.push_back({{rotation_exp<double>({0, 0, 2 * kPi * f / 60.0 + 1}), {0, 0, 1}}});
  FitReport report;
  const Clip clip = fit_clip(input, {}, report);
  EXPECT_LE(report.max_mm, 1.0001);
  ASSERT_EQ(clip.groups.size(), 1u);
  EXPECT_EQ(clip.groups[0].packings[0].components, 4);
  EXPECT_GT(packed_bytes(clip), 0u);
}

}  // namespace
}  // namespace sinew::convert
