// The SIMD kernels against each other and against plain arithmetic.
#include "sinew/animation/kernels/kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "fixtures/clips.h"
#include "sinew/animation/bspline.h"
#include "sinew/animation/sampling_job.h"

namespace sinew {
namespace {

using kernels::JetLayout;
using kernels::SplineSpan;

constexpr unsigned kSeed = 20261121;

/// A group of random tracks on every other joint, backwards.
template <class T>
struct RandomSpan {
  std::vector<float> controls;
  std::vector<int> joints;
  SplineSpan<T> span;

  RandomSpan(int terms, int tracks) : controls(6 * 4 * tracks), joints(tracks) {
    std::mt19937 random(kSeed);
    std::normal_distribution<float> normal;
    for (float& c : controls) c = normal(random);
    for (int k = 0; k < tracks; ++k) joints[k] = 2 * (tracks - 1 - k);
    span.terms = terms;
    for (int t = 0; t < 6; ++t) {
      span.rows[t] = controls.data() + 4 * tracks * t;
      span.value[t] = T(normal(random));
      span.first[t] = T(normal(random));
      span.second[t] = T(normal(random));
    }
    span.joints = joints.data();
    span.tracks = tracks;
    span.joint_end = 2 * tracks;
  }
};

template <class T>
void expect_same_bits(int terms, int tracks) {
  const RandomSpan<T> random(terms, tracks);
  std::vector<JetLayout<T>> narrow(2 * tracks), wide(2 * tracks);
  kernels::baseline::rotations(random.span, narrow.data());
  kernels::avx2::rotations(random.span, wide.data());
  EXPECT_EQ(std::memcmp(narrow.data(), wide.data(), sizeof(JetLayout<T>) * narrow.size()), 0)
      << terms << " " << tracks;
  kernels::baseline::translations(random.span, narrow.data());
  kernels::avx2::translations(random.span, wide.data());
  EXPECT_EQ(std::memcmp(narrow.data(), wide.data(), sizeof(JetLayout<T>) * narrow.size()), 0)
      << terms << " " << tracks;
}

TEST(Kernels, EveryInstructionSetGivesTheSameBits) {
  if (!kernels::has_avx2()) GTEST_SKIP() << "this processor has no AVX2";
  for (const int terms : {4, 6})
    for (int tracks = 1; tracks < 40; ++tracks) {
      expect_same_bits<float>(terms, tracks);
      expect_same_bits<double>(terms, tracks);
    }
}

/// Sums and projection of one rotation track, one number after the other.
JointJet<double> slow_rotation(const SplineSpan<double>& span, int track) {
  using Vec4 = Eigen::Vector4d;
  Vec4 p = Vec4::Zero(), dp = Vec4::Zero(), ddp = Vec4::Zero();
  for (int t = 0; t < span.terms; ++t) {
    const Vec4 c = Eigen::Map<const Eigen::Vector4f>(span.rows[t] + 4 * track).cast<double>();
    p += span.value[t] * c;
    dp += span.first[t] * c;
    ddp += span.second[t] * c;
  }
  const Quat<double> inverse = Quat<double>(p).conjugate();
  const Vec3<double> omega = 2 * (inverse * Quat<double>(dp)).vec() / p.squaredNorm();
  const Vec3<double> alpha =
      2 * (inverse * Quat<double>(ddp)).vec() / p.squaredNorm() - omega * (2 * p.dot(dp) / p.squaredNorm());
  return {Quat<double>(p.normalized()), omega, alpha};
}

TEST(Kernels, EveryTrackOfEveryGroupSizeIsTheFormulasOwn) {
  for (const int tracks : {1, 3, 4, 5, 7, 8, 9, 16, 19}) {
    const RandomSpan<double> random(6, tracks);
    std::vector<JetLayout<double>> jets(2 * tracks);
    kernels::baseline::rotations(random.span, jets.data());
    for (int k = 0; k < tracks; ++k) {
      const JointJet<double> wanted = slow_rotation(random.span, k);
      const JetLayout<double>& jet = jets[random.joints[k]];
      // Rounding of sums of a dozen products, divided by |p|² ≥ 1e-3 for this seed.
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(jet.rotation[i], wanted.rotation.coeffs()[i], 1e-12);
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(jet.omega[i], wanted.omega[i], 1e-10 * (1 + wanted.omega.norm()));
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(jet.alpha[i], wanted.alpha[i], 1e-10 * (1 + wanted.alpha.norm()));
      EXPECT_EQ(jets[random.joints[k] + 1].rotation[3], 0) << "a joint without a track was written";
    }
  }
}

TEST(Bspline, WeightsSumToOneAndDerivativesAreTheValuesOwn) {
  constexpr double h = 1e-5;
  for (const int degree : {3, 5})
    for (double u = h; u < 1; u += 0.0731) {
      const auto now = BsplineBasis<double>::at(degree, u);
      const auto before = BsplineBasis<double>::at(degree, u - h),
                 after = BsplineBasis<double>::at(degree, u + h);
      double sum = 0;
      for (int j = 0; j <= degree; ++j) {
        sum += now.value[j];
        EXPECT_NEAR(now.first[j], (after.value[j] - before.value[j]) / (2 * h), 1e-8);
        EXPECT_NEAR(now.second[j], (after.first[j] - before.first[j]) / (2 * h), 1e-8);
      }
      EXPECT_NEAR(sum, 1, 1e-14);
    }
}

TEST(Bspline, NextSpanContinuesTheLast) {
  for (const int degree : {3, 5}) {
    const auto end = BsplineBasis<double>::at(degree, 1), begin = BsplineBasis<double>::at(degree, 0);
    for (int j = 0; j < degree; ++j) {
      EXPECT_NEAR(end.value[j + 1], begin.value[j], 1e-14);
      EXPECT_NEAR(end.first[j + 1], begin.first[j], 1e-14);
      EXPECT_NEAR(end.second[j + 1], begin.second[j], 1e-14);
    }
  }
}

TEST(Sampling, PosesAloneAreThoseOfTheJets) {
  const Clip clip = fixtures::random_clip({.joints = 21, .duration = 2, .moving = 3});
  std::vector<JointJet<float>> jets(21);
  std::vector<Transform<float>> poses(21);
  for (double t = 0; t < 5; t += 0.137) {
    ASSERT_TRUE((SamplingJob<float>{&clip, t, jets, poses}.Run().ok()));
    for (int j = 0; j < 21; ++j) {
      EXPECT_EQ(poses[j].rotation.coeffs(), jets[j].rotation.coeffs());
      EXPECT_EQ(poses[j].translation, jets[j].translation);
    }
  }
}

TEST(Sampling, ShorterOutputSamplesItsJointsAndNothingElse) {
  const Clip clip = fixtures::random_clip({.joints = 21, .duration = 2, .moving = 9});
  std::vector<JointJet<float>> all(21), few(21);
  for (JointJet<float>& jet : few) jet.omega.setConstant(77);
  ASSERT_TRUE((SamplingJob<float>{&clip, 0.4, all}.Run().ok()));
  ASSERT_TRUE((SamplingJob<float>{&clip, 0.4, std::span(few).first(6)}.Run().ok()));
  for (int j = 0; j < 6; ++j) {
    EXPECT_EQ(few[j].rotation.coeffs(), all[j].rotation.coeffs());
    EXPECT_EQ(few[j].alpha, all[j].alpha);
    EXPECT_EQ(few[j].acceleration, all[j].acceleration);
  }
  for (int j = 6; j < 21; ++j) EXPECT_EQ(few[j].omega.x(), 77);
}

TEST(Sampling, FloatAgreesWithDouble) {
  const Clip clip = fixtures::random_clip({.joints = 21, .duration = 2, .moving = 3});
  std::vector<JointJet<float>> single(21);
  std::vector<JointJet<double>> twice(21);
  for (double t = 0; t < 2; t += 0.0731) {
    ASSERT_TRUE((SamplingJob<float>{&clip, t, single}.Run().ok()));
    ASSERT_TRUE((SamplingJob<double>{&clip, t, twice}.Run().ok()));
    for (int j = 0; j < 21; ++j) {
      // 15 knots a second: second derivatives are 225 times a sum of six controls rounded to 1e-7.
      EXPECT_LT(single[j].rotation.cast<double>().angularDistance(twice[j].rotation), 1e-5);
      EXPECT_LT((single[j].omega.cast<double>() - twice[j].omega).norm(), 1e-3);
      EXPECT_LT((single[j].alpha.cast<double>() - twice[j].alpha).norm(), 5e-2);
      EXPECT_LT((single[j].acceleration.cast<double>() - twice[j].acceleration).norm(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace sinew
