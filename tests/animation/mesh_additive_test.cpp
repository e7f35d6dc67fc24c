#include <gtest/gtest.h>

#include <cmath>

#include "animation/moving_pose.h"
#include "sinew/animation/mesh_additive_job.h"

namespace sinew {
namespace {

using fixtures::Pose;
using fixtures::sampled;

constexpr double kPi = 3.14159265358979323846;
const std::vector<int> kParents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
const int kJoints = static_cast<int>(kParents.size());
std::vector<MovingRotation<double>> scratch(2 * kParents.size());

Quat<double> in_model(const Pose& jets, int joint) {
  return joint < 0 ? Quat<double>::Identity() : in_model(jets, kParents[joint]) * jets[joint].rotation;
}

TEST(MeshAdditive, DifferenceAddedInFullToItsReferenceIsTheMotionAgain) {
  const Pose motion = sampled(fixtures::smooth_clip(1), 0.7),
             reference = sampled(fixtures::smooth_clip(2), 0.7);
  Pose difference(kJoints), out = reference;
  subtract_in_model<double>(kParents, reference, motion, scratch, difference);
  ASSERT_TRUE((MeshAdditiveJob<double>{kParents, out, difference, {1, 0, 0}, {}, scratch}.Run().ok()));
  for (int j = 0; j < kJoints; ++j) {  // rounding along a chain of six
    EXPECT_LT(out[j].rotation.angularDistance(motion[j].rotation), 1e-6) << j;
    EXPECT_LT((out[j].omega - motion[j].omega).norm(), 1e-10) << j;
    EXPECT_LT((out[j].alpha - motion[j].alpha).norm(), 1e-8) << j;
  }
}

TEST(MeshAdditive, AimOnALeaningBodyKeepsItsPitchInTheWorld) {
  // Upright, the aim raises the chest (joint 2) and all above it by 30 degrees about y.
  Pose upright(kJoints), raised(kJoints), difference(kJoints);
  const Vec3<double> raise = Vec3<double>(0, -30 * kPi / 180, 0);
  raised[2].rotation = rotation_exp<double>(raise);
  subtract_in_model<double>(kParents, upright, raised, scratch, difference);
  for (const double lean : {10.0, 40.0}) {  // sideways, degrees
    Pose leaning(kJoints);
    leaning[1].rotation = rotation_exp<double>({lean * kPi / 180, 0, 0.3});
    Pose out = leaning;
    ASSERT_TRUE((MeshAdditiveJob<double>{kParents, out, difference, {1, 0, 0}, {}, scratch}.Run().ok()));
    for (const int joint : {2, 3, 5, 7}) {
      const Quat<double> turn = in_model(out, joint) * in_model(leaning, joint).conjugate();
      EXPECT_LT(turn.angularDistance(rotation_exp<double>(raise)) * 180 / kPi, 0.1) << joint;  // degrees
    }
  }
}

TEST(MeshAdditive, JointsThatTheLayerDoesNotTouchKeepTheirBits) {
  const Pose motion = sampled(fixtures::smooth_clip(1), 0.7), base = sampled(fixtures::smooth_clip(2), 0.7);
  Pose difference(kJoints);
  subtract_in_model<double>(kParents, base, motion, scratch, difference);
  std::vector<double> mask(kJoints, 0);
  mask[4] = 0.5;  // and its child, which has to be turned back
  Pose out = base;
  ASSERT_TRUE((MeshAdditiveJob<double>{kParents, out, difference, {0.7, 1, 2}, mask, scratch}.Run().ok()));
  for (int j = 0; j < kJoints; ++j)
    if (j != 4 && j != 5) fixtures::expect_same_bits(out[j], base[j]);
  EXPECT_LT(in_model(out, 5).angularDistance(in_model(base, 5)), 1e-7) << "stays as it was in model space";
  out = base;
  ASSERT_TRUE((MeshAdditiveJob<double>{kParents, out, difference, {0, 0, 0}, {}, scratch}.Run().ok()));
  for (int j = 0; j < kJoints; ++j) fixtures::expect_same_bits(out[j], base[j]);
}

TEST(MeshAdditive, RefusesWhatCannotBeMeant) {
  Pose jets = sampled(fixtures::smooth_clip(1), 0.7);
  const Pose difference(kJoints);
  const auto status_of = [&](auto change) {
    MeshAdditiveJob<double> job{kParents, jets, difference, {1, 0, 0}, {}, scratch};
    change(job);
    return job.Run();
  };
  EXPECT_TRUE(status_of([](auto&) {}).ok());
  EXPECT_FALSE(status_of([](auto& job) { job.scratch = job.scratch.first(5); }).ok());
  EXPECT_EQ(status_of([](auto& job) { job.weight.value = -1; }).code, Code::kOutOfRange);
  EXPECT_EQ(status_of([](auto& job) { job.weight.rate = NAN; }).code, Code::kNotFinite);
  const std::vector<int> tangled = {-1, 2, 1, 2, 3, 4, 2, 6, 0, 8, 9};
  EXPECT_EQ(status_of([&](auto& job) { job.parents = tangled; }).index, 1);
}

}  // namespace
}  // namespace sinew
