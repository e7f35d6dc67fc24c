#include <cmath>
#include <cstring>
#include <random>

#include "animation/moving_pose.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/kernels/layout.h"

namespace sinew {
namespace {

using fixtures::Pose;
using fixtures::sampled;
using Layer = BlendLayer<double>;

const Clip kWalk = fixtures::smooth_clip(1), kRun = fixtures::smooth_clip(2),
           kWave = fixtures::smooth_clip(3);
const std::vector<double> kMask = {0, 1, 0.5, 0.25, 1, 0, 0.75, 1, 1, 0, 0.1};

/// w = a + b·sin(2t + c).
TimeJet<double> swaying(double t, double a, double b, double c) {
  return {a + b * std::sin(2 * t + c), 2 * b * std::cos(2 * t + c), -4 * b * std::sin(2 * t + c)};
}

Pose blended(const std::vector<Layer>& layers, std::span<const Transform<double>> rest = {}) {
  Pose out(kMask.size());
  const Status status = BlendingJob<double>{layers, rest, out}.Run();
  EXPECT_TRUE(status.ok()) << status.reason;
  return out;
}

std::vector<Transform<double>> reference_pose() {
  std::vector<Transform<double>> pose;
  for (const JointJet<double>& jet : sampled(kWave, 3.3)) pose.push_back({jet.rotation, jet.translation});
  return pose;
}

TEST(Blending, MixOfThreeMovesAsItsDerivativesSay) {
  fixtures::expect_consistent(
      [](double t) {
        const Pose a = sampled(kWalk, t), b = sampled(kRun, t), c = sampled(kWave, t);
        return blended(
            {{a, swaying(t, 0.5, 0.3, 0)}, {b, swaying(t, 1, 0.9, 1)}, {c, swaying(t, 0.4, 0.2, 2), kMask}});
      },
      {0.31, 0.9, 1.7, 2.6});
}

TEST(Blending, MaskedOverrideMovesAsItsDerivativesSay) {
  fixtures::expect_consistent(
      [](double t) {
        const Pose a = sampled(kWalk, t), b = sampled(kRun, t);
        return blended({{a}, {b, swaying(t, 0.5, 0.4, 0), kMask, BlendMode::kOverride}});
      },
      {0.31, 0.9, 1.7, 2.6});
}

TEST(Blending, AdditiveLayerMovesAsItsDerivativesSay) {
  const std::vector<Transform<double>> reference = reference_pose();
  fixtures::expect_consistent(
      [&](double t) {
        const Pose a = sampled(kWalk, t);
        Pose difference = sampled(kWave, t);
        subtract_reference<double>(reference, difference, difference);
        return blended({{a}, {difference, swaying(t, 0.6, 0.3, 1), kMask, BlendMode::kAdditive}});
      },
      {0.31, 0.9, 1.7, 2.6});
}

TEST(Blending, DifferenceAddedInFullToItsReferenceIsTheMotionAgain) {
  const std::vector<Transform<double>> reference = reference_pose();
  Pose base(reference.size());
  for (std::size_t j = 0; j < base.size(); ++j) {
    base[j].rotation = reference[j].rotation;
    base[j].translation = reference[j].translation;
  }
  const Pose motion = sampled(kWave, 0.8);
  Pose difference(motion.size());
  subtract_reference<double>(reference, motion, difference);
  const Pose again = blended({{base}, {difference, {1, 0, 0}, {}, BlendMode::kAdditive}});
  for (std::size_t j = 0; j < motion.size(); ++j) {  // rounding of a handful of products
    EXPECT_LT(again[j].rotation.angularDistance(motion[j].rotation), 1e-7);
    EXPECT_LT((again[j].omega - motion[j].omega).norm(), 1e-12);
    EXPECT_LT((again[j].alpha - motion[j].alpha).norm(), 1e-11);
    EXPECT_LT((again[j].acceleration - motion[j].acceleration).norm(), 1e-12);
  }
}

TEST(Blending, AdditiveMotionWithAReferenceIsItsDifferenceWithout) {
  const std::vector<Transform<double>> reference = reference_pose();
  const Pose base = sampled(kWalk, 0.3), motion = sampled(kWave, 0.8);
  Pose difference(motion.size());
  subtract_reference<double>(reference, motion, difference);
  const TimeJet<double> weight{0.7, 0.1, 3};
  const Pose wanted = blended({{base}, {difference, weight, kMask, BlendMode::kAdditive}}),
             got = blended({{base}, {motion, weight, kMask, BlendMode::kAdditive, reference}});
  for (std::size_t j = 0; j < motion.size(); ++j) {  // rounding of a product
    EXPECT_LT(got[j].rotation.angularDistance(wanted[j].rotation), 1e-7);
    EXPECT_LT((got[j].alpha - wanted[j].alpha).norm(), 1e-11);
    EXPECT_LT((got[j].translation - wanted[j].translation).norm(), 1e-14);
  }
  std::vector<BlendLayer<double>> layers = {{base}, {motion, weight, {}, BlendMode::kAdditive, reference}};
  layers[1].reference = layers[1].reference.first(1);
  Pose out(base.size());
  EXPECT_EQ((BlendingJob<double>{layers, {}, out}.Run().index), 1);
}

TEST(Blending, MaskOfZeroLeavesTheBitsBelowAloneAndMaskOfOneCutsThemOut) {
  const Pose a = sampled(kWalk, 0.7), b = sampled(kRun, 0.7);
  const Pose over = blended({{a}, {b, {1, 0, 0}, kMask, BlendMode::kOverride}});
  const Pose added = blended({{a}, {b, {0.7, 0.1, 3}, kMask, BlendMode::kAdditive}});
  const Pose mixed = blended({{a}, {b, {0.7, 0.1, 3}, kMask}});
  for (std::size_t j = 0; j < kMask.size(); ++j) {
    SCOPED_TRACE(j);
    if (kMask[j] == 1) fixtures::expect_same_bits(over[j], b[j]);
    if (kMask[j] != 0) continue;
    fixtures::expect_same_bits(over[j], a[j]);
    fixtures::expect_same_bits(added[j], a[j]);
    fixtures::expect_same_bits(mixed[j], a[j]);
  }
}

TEST(Blending, OnlyMixedLayerKeepsItsBitsWhateverItsWeight) {
  const Pose a = sampled(kWalk, 0.7), b = sampled(kRun, 0.7);
  const Pose out = blended({{a, {0.3, 5, 9}}, {b, {0, 0, 0}}});
  for (std::size_t j = 0; j < a.size(); ++j) fixtures::expect_same_bits(out[j], a[j]);
}

TEST(Blending, JointsThatNoLayerReachesRest) {
  const Pose a = sampled(kWalk, 0.7);
  const std::vector<Transform<double>> rest = reference_pose();
  const Pose out = blended({{a, {1, 0, 0}, kMask}}, rest), nothing = blended({});
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_EQ(nothing[j].rotation.coeffs(), Quat<double>::Identity().coeffs());
    if (kMask[j] != 0) continue;
    EXPECT_EQ(out[j].rotation.coeffs(), rest[j].rotation.coeffs());
    EXPECT_EQ(out[j].translation, rest[j].translation);
    EXPECT_EQ(out[j].omega, Vec3<double>::Zero());
  }
}

TEST(Blending, SignOfAQuaternionMeansNothing) {
  const Pose a = sampled(kWalk, 0.7);
  Pose b = sampled(kRun, 0.7);
  const auto all = [&] {
    return blended({{a, {0.4, 1, 2}},
                    {b, {0.6, -1, 0}},
                    {b, {0.5, 0, 0}, {}, BlendMode::kOverride},
                    {b, {0.5, 0, 0}, {}, BlendMode::kAdditive}});
  };
  const Pose before = all();
  for (JointJet<double>& jet : b) jet.rotation.coeffs() *= -1;
  const Pose after = all();
  for (std::size_t j = 0; j < a.size(); ++j) fixtures::expect_same_bits(after[j], before[j]);
}

TEST(Blending, MixDependsOnTheRatioOfWeightsAlone) {
  const Pose a = sampled(kWalk, 0.7), b = sampled(kRun, 0.7);
  const Pose once = blended({{a, {0.25, 0.5, 1}}, {b, {0.5, 1, -2}}});
  const Pose twice = blended({{a, {0.5, 1, 2}}, {b, {1, 2, -4}}});
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_LT(once[j].rotation.angularDistance(twice[j].rotation), 1e-7);
    EXPECT_LT((once[j].alpha - twice[j].alpha).norm(), 1e-10);
    EXPECT_LT((once[j].acceleration - twice[j].acceleration).norm(), 1e-10);
  }
}

TEST(Blending, OutputMayBeALayer) {
  const Pose a = sampled(kWalk, 0.7), b = sampled(kRun, 0.7);
  const Pose apart = blended({{a, {0.4, 1, 2}}, {b, {0.6, 0, 0}}});
  Pose in_place = a;
  const Layer layers[] = {{in_place, {0.4, 1, 2}}, {b, {0.6, 0, 0}}};
  ASSERT_TRUE((BlendingJob<double>{layers, {}, in_place}.Run().ok()));
  for (std::size_t j = 0; j < a.size(); ++j) fixtures::expect_same_bits(in_place[j], apart[j]);
}

TEST(Blending, EveryJointCountAndInstructionSetGivesTheSameBits) {
  const Clip one = fixtures::random_clip({.joints = 21, .moving = 9, .seed = 5});
  const Clip two = fixtures::random_clip({.joints = 21, .moving = 9, .seed = 6});
  std::vector<JointJet<float>> a(21), b(21), all(21);
  ASSERT_TRUE((SamplingJob<float>{&one, 1, a}.Run().ok()));
  ASSERT_TRUE((SamplingJob<float>{&two, 1, b}.Run().ok()));
  const kernels::BlendLayerData<float> data[] = {
      {kernels::layout(a.data()), nullptr, {0.3f, 1, 2}, kernels::BlendLayerData<float>::kMix},
      {kernels::layout(b.data()), nullptr, {0.9f, -1, 7}, kernels::BlendLayerData<float>::kMix},
      {kernels::layout(b.data()), nullptr, {0.4f, 1, 0}, kernels::BlendLayerData<float>::kAdditive}};
  const kernels::BlendData<float> blend{data, 3, nullptr};
  kernels::baseline::blend(blend, 21, kernels::layout(all.data()));
  for (int joints = 1; joints <= 21; ++joints) {
    std::vector<JointJet<float>> some(joints);
    SINEW_DISPATCH(blend(blend, joints, kernels::layout(some.data())));
    for (int j = 0; j < joints; ++j) {
      EXPECT_EQ(some[j].rotation.coeffs(), all[j].rotation.coeffs()) << j << " of " << joints;
      EXPECT_EQ(some[j].alpha, all[j].alpha) << j << " of " << joints;
      EXPECT_EQ(some[j].acceleration, all[j].acceleration) << j << " of " << joints;
    }
  }
}

TEST(Blending, RefusesWhatCannotBeMeant) {
  const Pose a = sampled(kWalk, 0.7);
  Pose out(a.size());
  const auto status_of = [&](const Layer& layer) {
    const Layer layers[] = {{a}, layer};
    return BlendingJob<double>{layers, {}, out}.Run();
  };
  EXPECT_EQ(status_of({std::span(a).first(3)}).index, 1);
  EXPECT_EQ(status_of({a, {-0.1, 0, 0}}).code, Code::kOutOfRange);
  EXPECT_EQ(status_of({a, {0.5, NAN, 0}}).code, Code::kNotFinite);
  EXPECT_EQ(status_of({a, {1, 0, 0}, std::span(kMask).first(3)}).code, Code::kInvalidArgument);
  std::vector<double> mask = kMask;
  mask[4] = 1.5;
  EXPECT_EQ(status_of({a, {1, 0, 0}, mask}).code, Code::kOutOfRange);
  mask[4] = NAN;
  EXPECT_EQ(status_of({a, {1, 0, 0}, mask}).code, Code::kOutOfRange);
  const std::vector<Layer> too_many(BlendingJob<double>::kMaxLayers + 1, {a});
  EXPECT_FALSE((BlendingJob<double>{too_many, {}, out}.Run().ok()));
  const std::vector<Transform<double>> rest(2);
  EXPECT_FALSE((BlendingJob<double>{{}, rest, out}.Run().ok()));
}

}  // namespace
}  // namespace sinew
