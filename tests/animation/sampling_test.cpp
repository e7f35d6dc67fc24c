#include <gtest/gtest.h>

#include <cmath>

#include "convert/fit/clip_fit.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Two joints in band-limited motion, one cycle of two seconds.
Transform<double> truth(int joint, double t) {
  const double a = kPi * t;
  if (joint == 0)
    return {rotation_exp<double>({0.3 * std::sin(a), 0.2 * std::cos(a), 0}), {std::sin(a), 0.5 * t, 1}};
  return {rotation_exp<double>({0.9 * std::sin(2 * a), 0, 0.4 * std::sin(3 * a + 1)}), {0, 0, 0.4}};
}

Clip fitted(int degree, convert::FitReport& report) {
  convert::FitInput input{"motion", true, 30, {}};
  for (int f = 0; f <= 60; ++f) input.samples.push_back({truth(0, f / 30.0), truth(1, f / 30.0)});
  convert::FitOptions options;
  options.degree = degree;
  return convert::fit_clip(input, options, report);
}

std::vector<JointJet<double>> sampled(const Clip& clip, double t, double rate = 1) {
  std::vector<JointJet<double>> jets(2);
  EXPECT_TRUE((SamplingJob<double>{&clip, {t, rate}, jets}.Run().ok()));
  return jets;
}

TEST(Sampling, VelocitiesAndAccelerationsAreTheCurvesOwn) {
  convert::FitReport report;
  for (const int degree : {3, 5}) {
    const Clip clip = fitted(degree, report);
    constexpr double h = 1e-4;
    for (double t = 0.0137; t < 4; t += 0.0731) {  // two loops, the seam included
      const auto now = sampled(clip, t), before = sampled(clip, t - h), after = sampled(clip, t + h);
      for (std::size_t j = 0; j < 2; ++j) {
        const Vec3<double> step =
            rotation_log<double>(before[j].rotation.conjugate() * after[j].rotation) / (2 * h);
        EXPECT_LT((step - now[j].omega).norm(), 2e-5)
            << degree << " " << t;  // h² times a third derivative of a few hundred
        EXPECT_LT(((after[j].omega - before[j].omega) / (2 * h) - now[j].alpha).norm(), 1e-3)
            << degree << " " << t;
        EXPECT_LT(((after[j].translation - before[j].translation) / (2 * h) - now[j].velocity).norm(), 1e-6);
        EXPECT_LT(((after[j].velocity - before[j].velocity) / (2 * h) - now[j].acceleration).norm(), 1e-3);
      }
    }
  }
}

TEST(Sampling, FitStaysWithinItsBudgetAndKeepsTheRootGoing) {
  convert::FitReport report;
  const Clip clip = fitted(5, report);
  EXPECT_LE(report.max_mm, 1.0);
  EXPECT_TRUE(clip.loops);
  for (double t = 0; t < 2; t += 0.033) {
    const auto jets = sampled(clip, t + 2);  // second loop: the root has moved on by one metre
    EXPECT_LT((jets[0].translation - truth(0, t).translation - Vec3<double>(0, 1, 0)).norm(), 2e-3);
    EXPECT_LT(jets[1].rotation.angularDistance(truth(1, t).rotation), 0.011);
  }
}

TEST(Sampling, RateScalesVelocitiesAndAccelerations) {
  convert::FitReport report;
  const Clip clip = fitted(5, report);
  const auto once = sampled(clip, 0.7), twice = sampled(clip, 0.7, 2);
  EXPECT_TRUE(twice[1].omega.isApprox(2 * once[1].omega, 1e-9));
  EXPECT_TRUE(twice[1].alpha.isApprox(4 * once[1].alpha, 1e-9));
}

TEST(Sampling, RefusesWhatCannotBeMeant) {
  convert::FitReport report;
  const Clip clip = fitted(3, report);
  std::vector<JointJet<float>> jets(2);
  EXPECT_FALSE((SamplingJob<float>{nullptr, 0, jets}.Run().ok()));
  EXPECT_EQ((SamplingJob<float>{&clip, NAN, jets}.Run().code), Code::kNotFinite);
  EXPECT_FALSE((SamplingJob<float>{&clip, {0, 1e9}, jets}.Run().ok()));
  Clip broken = clip;
  broken.groups[0].controls.pop_back();
  EXPECT_FALSE(validate(broken).ok());
  broken = clip;
  broken.groups[0].tracks[0].joint = 7;
  EXPECT_FALSE(validate(broken).ok());
  broken = clip;
  broken.groups[0].controls[0] = NAN;
  EXPECT_EQ(validate(broken).code, Code::kNotFinite);
}

/// A weight above 1 leaves a negative one for the other layer, which BlendingJob refuses.
TEST(EaseWeight, NeverPassesOne) {
  int below = 0;
  for (int n = 0; n <= 2000; ++n) {
    const float elapsed = 0.5f * (1 - 1e-5f * static_cast<float>(n));
    const float value = EaseWeight<float>::at(elapsed, 0.5f).value;
    EXPECT_LE(value, 1.f) << elapsed;
    below += value < 1;
  }
  EXPECT_GT(below, 100);
}

TEST(Crossfade, DerivativesAreThoseOfTheBlendedPose) {
  convert::FitReport report;
  const Clip clip = fitted(5, report);
  const auto blended = [&](double t) {
    std::vector<JointJet<double>> a = sampled(clip, t), b = sampled(clip, t + 0.6), out(2);
    crossfade<double>(a, b, EaseWeight<double>::at(t - 0.3, 0.8), out);
    return out;
  };
  constexpr double h = 1e-4;
  for (double t = 0.35; t < 1.05; t += 0.05) {
    const auto now = blended(t), before = blended(t - h), after = blended(t + h);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_LT(
          (rotation_log<double>(before[j].rotation.conjugate() * after[j].rotation) / (2 * h) - now[j].omega)
              .norm(),
          1e-4);
      EXPECT_LT(((after[j].omega - before[j].omega) / (2 * h) - now[j].alpha).norm(), 5e-3);
      EXPECT_LT(((after[j].velocity - before[j].velocity) / (2 * h) - now[j].acceleration).norm(), 5e-3);
    }
  }
}

}  // namespace
}  // namespace sinew
