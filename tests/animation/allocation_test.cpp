// No job of the animation layer takes memory from the heap.
#include <gtest/gtest.h>

#include "animation/moving_pose.h"
#include "fixtures/counting_new.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/root_motion.h"
#include "sinew/animation/skinning_job.h"

namespace sinew {
namespace {

TEST(Allocation, SamplingToSkinningTakesNothingFromTheHeap) {
  constexpr int kJoints = 11;
  Clip clip = fixtures::random_clip({.joints = kJoints, .duration = 4, .moving = kJoints});
  clip.curves = {{1, 1, std::vector<float>(7, 0.5f)}};
  const std::vector<CurveSlot> slots = {{"strength", 1}, {"smile", 0}};
  std::vector<TimeJet<float>> curves(slots.size());
  std::vector<JointJet<float>> a(kJoints), b(kJoints), pose(kJoints);
  std::vector<Transform<float>> poses(kJoints), model(kJoints);
  const std::vector<int> parents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
  const std::vector<float> mask(kJoints, 0.5f), weights(4, 0.25f), positions(3, 1);
  const std::vector<std::uint16_t> joints = {0, 1, 2, 3};
  std::vector<SkinMatrix> palette(kJoints);
  std::vector<float> out(3), normals(3);
  const long before = fixtures::allocations;
  std::vector<int> counted(1);
  EXPECT_EQ(fixtures::allocations - before, 1) << "the counter does not count";
  bool ok = true;
  const long start = fixtures::allocations;
  for (double t = 0; t < 1; t += 0.1) {
    ok &= SamplingJob<float>{&clip, t, a, poses}.Run().ok();
    ok &= SamplingJob<float>{&clip, t + 1, b}.Run().ok();
    ok &= CurveJob<float>{&clip, t, slots, curves}.Run().ok();
    const CurveLayer<float> both[] = {{curves}, {curves, 0.5f}};
    ok &= CurveBlendingJob<float>{both, slots, curves}.Run().ok();
    const BlendLayer<float> layers[] = {
        {a}, {b, {0.5f, 0, 0}, mask, BlendMode::kOverride}, {b, {0.1f, 0, 0}, {}, BlendMode::kAdditive}};
    ok &= BlendingJob<float>{layers, {}, pose}.Run().ok();
    const Vec3<float> wanted = value_of<float>(model_motion<float>(pose, parents, 5).translation) * 0.9f;
    TwoBoneJob<float> limb{parents, pose, 3, 4, 5};
    limb.target = still<float>(wanted);
    ok &= limb.Run().ok();
    AimJob<float> aim{parents, pose, 7};
    aim.target = still<float>({9, 9, 9});
    ok &= aim.Run().ok();
    pose[0] = split_root(pose[0]).body;
    ok &= ModelPoseJob<float>{parents, pose, {}, {}, model}.Run().ok();
    skinning_palette(model, poses, palette);
    ok &= SkinningJob{palette, 4, joints, weights, positions, positions, out, normals}.Run().ok();
  }
  EXPECT_EQ(fixtures::allocations - start, 0);
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace sinew
