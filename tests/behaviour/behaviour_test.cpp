// A standing body that is pushed: it presses, steps, puts the foot back, or falls.
#include "pushed.h"

namespace sinew {
namespace {

using fixtures::Pushed;

constexpr double kBack = 3.14159265358979323846, kLeft = kBack / 2;

struct Balancing : Pushed {
  Status status;
  Behaviour<float> behaviour;
  int steps = 0;    ///< most that were counted
  double slip = 0;  ///< m, of a foot that stands, furthest in a frame
  double help = 0;  ///< N·m, largest

  explicit Balancing(const BehaviourSettings& settings = {})
      : Pushed("stand"), behaviour(asset.skeleton, settings, status) {
    EXPECT_TRUE(status) << status.reason;
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
      steps = std::max(steps, behaviour.report().steps);
    };
  }
  BehaviourState pushed(double impulse, double direction, double seconds = 7) {
    run(0.3);
    push(impulse, direction);
    run(seconds);
    return behaviour.state();
  }
};

TEST(Behaviour, NothingHappensWhileNothingDisturbs) {
  Balancing body;
  Pushed plain("stand");
  for (int n = 0; n < 120; ++n) {
    body.step();
    plain.step();
    ASSERT_EQ(body.character().model()[5].translation, plain.character().model()[5].translation);
  }
  EXPECT_EQ(body.solved, 0);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip);
}

TEST(Behaviour, ASmallPushIsPressedBackWithoutAStep) {
  for (const double direction : {0.0, kBack, kLeft}) {
    Balancing body;
    EXPECT_EQ(body.pushed(15, direction), BehaviourState::kClip) << direction;
    EXPECT_EQ(body.steps, 0) << direction;
  }
}

TEST(Behaviour, APushThatFeetCannotHoldIsCaughtByAStepAndTheFootIsPutBack) {
  Balancing body;
  EXPECT_EQ(body.pushed(40, 0), BehaviourState::kClip);
  EXPECT_GE(body.steps, 1);
  EXPECT_LE(body.steps, 2);
  EXPECT_GT(body.character().displacement().x, 0.05);
  // Back on its animation, from where it stands.
  const int before = body.solved;
  body.run(1);
  EXPECT_EQ(body.solved, before);
  Balancing behind;
  EXPECT_EQ(behind.pushed(40, kBack), BehaviourState::kClip);
  EXPECT_GE(behind.steps, 1);
  EXPECT_LT(behind.character().displacement().x, -0.05);
}

TEST(Behaviour, WhatNoStepCatchesIsAFallAndItLiesStill) {
  Balancing body;
  EXPECT_EQ(body.pushed(150, 0, 6), BehaviourState::kDown);
  EXPECT_LT(body.root_height(), 0.3);
  // The host takes over: as strong as before.
  body.behaviour.stand(body.character());
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip);
  EXPECT_EQ(body.character().strength(), 1.f);
}

TEST(Behaviour, IsKnockedDownWhenAsked) {
  Balancing body;
  body.run(0.3);
  body.behaviour.knock_down(body.character());
  body.run(4);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kDown);
  EXPECT_LT(body.root_height(), 0.3);
}

TEST(Behaviour, RepeatsToTheBit) {
  const auto run = [] {
    Balancing body;
    body.pushed(45, 0.3, 2);
    return Vec3<float>(body.character().model()[3].translation);
  };
  EXPECT_EQ(run(), run());
}

TEST(Behaviour, RefusesWhatItCannotBalance) {
  Balancing body;
  std::vector<JointJet<float>> few(3);
  EXPECT_FALSE(body.behaviour.update(body.character(), few, body.h));
  Skeleton legless = body.asset.skeleton;
  for (Joint& joint : legless.joints) joint.role = Role::kNone;
  Status status;
  const Behaviour<float> none(legless, {}, status);
  EXPECT_FALSE(status);
}

}  // namespace
}  // namespace sinew
