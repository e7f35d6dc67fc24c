// Compares the derivatives that a pose claims with central differences of the pose itself.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "fixtures/clips.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::fixtures {

using Pose = std::vector<JointJet<double>>;

inline Pose sampled(const Clip& clip, double time) {
  Pose jets(clip.joint_count);
  EXPECT_TRUE((SamplingJob<double>{&clip, time, jets}.Run().ok()));
  return jets;
}

/// Slow enough for differences to be exact: h² times the fourth power of the clip's 15 knots a second.
inline Clip smooth_clip(unsigned seed, int joints = 11) {
  return random_clip(
      {.joints = joints, .duration = 4, .knot_interval = 0.25f, .moving = joints, .seed = seed});
}

/// `pose(t)` moves as its own jets say, at and around every time given.
inline void expect_consistent(const std::function<Pose(double)>& pose, std::initializer_list<double> times,
                              double tolerance = 2e-5) {
  constexpr double h = 1e-4;  // error: h²/6 · third derivatives of up to 10³/s³, and rounding 1e-16/h²
  for (const double t : times) {
    const Pose now = pose(t), before = pose(t - h), after = pose(t + h);
    for (std::size_t j = 0; j < now.size(); ++j) {
      SCOPED_TRACE(testing::Message() << "joint " << j << " at " << t);
      const Vec3<double> turn =
          rotation_log<double>(before[j].rotation.conjugate() * after[j].rotation) / (2 * h);
      EXPECT_LT((turn - now[j].omega).norm(), tolerance);
      EXPECT_LT(((after[j].omega - before[j].omega) / (2 * h) - now[j].alpha).norm(), tolerance);
      EXPECT_LT(((after[j].translation - before[j].translation) / (2 * h) - now[j].velocity).norm(),
                tolerance);
      EXPECT_LT(((after[j].velocity - before[j].velocity) / (2 * h) - now[j].acceleration).norm(), tolerance);
      EXPECT_NEAR(now[j].rotation.norm(), 1, 1e-14);
    }
  }
}

inline void expect_same_bits(const JointJet<double>& a, const JointJet<double>& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.omega, b.omega);
  EXPECT_EQ(a.alpha, b.alpha);
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.acceleration, b.acceleration);
}

}  // namespace sinew::fixtures
