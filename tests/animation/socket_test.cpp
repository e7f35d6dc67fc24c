// Things in hands: where they are, that they do not lag, and how they leave.
#include "sinew/animation/socket.h"

#include <cmath>

#include "animation/moving_pose.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/model_motion_job.h"

namespace sinew {
namespace {

using fixtures::Pose;
using Vec = Vec3<double>;
using Moving = MovingTransform<double>;

const std::vector<int> kParents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
const Clip kClip = fixtures::smooth_clip(4);
const Socket<double> kPalm{5, {rotation_exp<double>({0.4, -0.2, 1}), {0.05, 0.02, 0}}};
const Transform<double> kHandle{rotation_exp<double>({0, 0.7, 0}), {-0.3, 0, 0.1}};

Moving place_at(double t) {
  JointJet<double> jet;
  jet.rotation = rotation_exp<double>({0, 0, 0.5 * t});
  jet.omega << 0, 0, 0.5;
  jet.translation << t, 2, 0;
  jet.velocity << 1, 0, 0;
  return moving_transform(jet);
}
std::vector<Moving> model_at(double t) {
  const Pose jets = fixtures::sampled(kClip, t);
  std::vector<Moving> model(jets.size());
  EXPECT_TRUE((ModelMotionJob<double>{kParents, jets, place_at(t), model}.Run().ok()));
  return model;
}
Moving item_at(double t) {
  const std::vector<Moving> model = model_at(t);
  return attached<double>(socket_motion<double>(kPalm, std::span<const Moving>(model)), kHandle);
}

TEST(ModelMotion, IsModelMotionOfEveryJointAtItsPlace) {
  const Pose jets = fixtures::sampled(kClip, 0.7);
  const std::vector<Moving> model = model_at(0.7);
  for (int i = 0; i < int(jets.size()); ++i) {
    const JointJet<double> a = joint_jet(model[std::size_t(i)]),
                           b = joint_jet<double>(place_at(0.7) * model_motion<double>(jets, kParents, i));
    EXPECT_LT(a.rotation.angularDistance(b.rotation), 1e-7) << i;
    EXPECT_LT((a.omega - b.omega).norm() + (a.velocity - b.velocity).norm(), 1e-12) << i;
    EXPECT_LT((a.alpha - b.alpha).norm() + (a.acceleration - b.acceleration).norm(), 1e-10) << i;
  }
}

TEST(ModelMotion, RefusesChildrenBeforeParentsAndShortInputs) {
  const Pose jets = fixtures::sampled(kClip, 0.7);
  std::vector<Moving> model(jets.size());
  std::vector<int> parents = kParents;
  EXPECT_FALSE((ModelMotionJob<double>{parents, std::span(jets).first(4), {}, model}.Run().ok()));
  parents[3] = 3;
  EXPECT_EQ((ModelMotionJob<double>{parents, jets, {}, model}.Run().index), 3);
}

TEST(Socket, ItemMovesAsItsJetsSay) {
  fixtures::expect_consistent([](double t) { return Pose{joint_jet(item_at(t))}; }, {0.31, 1.7}, 2e-4);
  const Pose jets = fixtures::sampled(kClip, 0.7);
  const Moving alone = socket_motion<double>(kPalm, jets, kParents, place_at(0.7));
  EXPECT_LT(
      (value_of<double>((alone * moving_transform(JointJet<double>{
                                     kHandle.inverse().rotation, {}, {}, kHandle.inverse().translation}))
                            .translation) -
       value_of<double>(item_at(0.7).translation))
          .norm(),
      1e-12)
      << "the walk up the chain is the same";
}

TEST(Socket, HandleLiesInThePalm) {
  const std::vector<Moving> model = model_at(0.7);
  const JointJet<double> palm = joint_jet(socket_motion<double>(kPalm, std::span<const Moving>(model))),
                         item = joint_jet(item_at(0.7));
  const Transform<double> handle = Transform<double>{item.rotation, item.translation} * kHandle;
  EXPECT_LT((handle.translation - palm.translation).norm(), 1e-12);
  EXPECT_LT(handle.rotation.angularDistance(palm.rotation), 1e-7);
}

TEST(Socket, WhatIsThrownHasTheHandsVelocity) {
  const Vec centre(0.2, -0.1, 0.3);
  constexpr double t = 0.7, h = 1e-4;
  const auto centre_at = [&](double time) { return value_of<double>(item_at(time) * still<double>(centre)); };
  const Release<double> thrown = release<double>(item_at(t), centre);
  const Vec found = (centre_at(t + h) - centre_at(t - h)) / (2 * h);
  EXPECT_LT((thrown.velocity - found).norm(), 1e-4) << "m/s";
  EXPECT_GT(thrown.velocity.norm(), 1) << "m/s: it is thrown";
  EXPECT_LT((thrown.pose.translation - centre_at(t)).norm(), 1e-12);
  const Quat<double> before = joint_jet(item_at(t - h)).rotation, after = joint_jet(item_at(t + h)).rotation;
  EXPECT_LT((rotation_log<double>(after * before.conjugate()) / (2 * h) - thrown.angular_velocity).norm(),
            1e-4);
}

TEST(Socket, TwoWhoCarryABoxDoNotLagBehindEachOther) {
  // The first holds the box; the second one's hand goes for its other handle, frame by frame at 30 Hz.
  const std::vector<int> parents = {-1, 0, 1, 2};
  const Transform<double> other_handle{Quat<double>::Identity(), {0, 0.4, 0}};
  for (int frame = 0; frame < 60; ++frame) {
    const double t = frame / 30.0;
    const Moving box = item_at(t);
    const MovingVector<double> goal = box * still<double>(other_handle.translation);
    Pose jets(4);
    jets[0].translation = value_of<double>(goal) + Vec(0.5, 0.1, 0.3);
    jets[0].velocity = rate_of<double>(goal);
    jets[0].acceleration = acceleration_of<double>(goal);
    jets[2].translation << 0, 0, -0.45;
    jets[2].rotation = rotation_exp<double>({0, -0.5, 0});
    jets[3].translation << 0, 0, -0.4;
    TwoBoneJob<double> arm{parents, jets, 1, 2, 3};
    arm.target = goal;
    ASSERT_TRUE(arm.Run().ok()) << t;
    const MovingVector<double> hand = model_motion<double>(jets, parents, 3).translation;
    EXPECT_LT((value_of<double>(hand) - value_of<double>(goal)).norm(), 1e-5) << "m, at " << t;
    EXPECT_LT((rate_of<double>(hand) - rate_of<double>(goal)).norm(), 1e-9) << "m/s, at " << t;
  }
}

TEST(Attachments, HoldersComeFirstAndCirclesAreRefused) {
  // A rider (0) on a horse (3) holds a lance (1) with a flag (2) on it; 4 stands alone.
  const std::vector<int> holders = {3, 0, 1, -1, -1};
  std::vector<int> order(5);
  ASSERT_TRUE(attachment_order(holders, order).ok());
  EXPECT_EQ(order, (std::vector<int>{3, 4, 0, 1, 2}));
  EXPECT_EQ(attachment_order(std::vector<int>{-1, 2, 1}, std::span(order).first(3)).index, 1);
  EXPECT_EQ(attachment_order(std::vector<int>{0}, std::span(order).first(1)).index, 0);
  EXPECT_EQ(attachment_order(std::vector<int>{-1, 5}, std::span(order).first(2)).code, Code::kOutOfRange);
  EXPECT_FALSE(attachment_order(holders, std::span(order).first(3)).ok());
  EXPECT_TRUE(attachment_order({}, {}).ok());
}

}  // namespace
}  // namespace sinew
