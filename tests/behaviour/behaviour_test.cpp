// A standing body that is pushed: it presses, steps, puts the foot back, or falls.
#include "pushed.h"
#include "sinew/skeleton/rotation.h"

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

/// Stands on a box that is led by its velocity and a turn rate.
struct Riding : Balancing {
  Vec3<double> velocity = Vec3<double>::Zero();
  double turn_rate = 0;
  bool led_by_host = false;  ///< the host has the animation go along

  Riding(const Vec3<double>& v, double turns, bool host = false)
      : velocity(v), turn_rate(turns), led_by_host(host) {
    Skeleton box;
    Joint joint;
    joint.name = "box";
    joint.type = JointType::kFree;
    joint.mass = 500;
    joint.inertia = Vec3<double>(700, 700, 1300).asDiagonal();
    box.joints = {joint};
    box.body_count = 1;
    Collider top;
    top.shape = Shape::kBox;
    top.size = {20, 20, 0.15};
    box.colliders = {top};
    CharacterSettings led;
    platform = world.add_character(box, led, status);
    EXPECT_TRUE(status) << status.reason;
    ground = 0.65f;
    lead(0);
    (void)world.character(platform).reset();
    sample();
    for (JointJet<float>& jet : std::span(jets).first(1)) jet.velocity += velocity.cast<float>();
    (void)character().set_target(jets);
    (void)character().reset();
    behave = [this, balance = behave](std::span<JointJet<float>> wanted) {
      lead(time());
      if (led_by_host) {
        wanted[0].translation += (time() * velocity).cast<float>();
        wanted[0].velocity += velocity.cast<float>();
      }
      balance(wanted);
    };
  }
  void lead(double time) {
    JointJet<float> at;
    at.rotation = rotation_exp<double>(Vec3<double>(0, 0, time * turn_rate)).cast<float>();
    at.omega = Vec3<float>(0, 0, float(turn_rate));
    at.translation = (Vec3<double>(0, 0, 0.5) + time * velocity).cast<float>();
    at.velocity = velocity.cast<float>();
    (void)world.character(platform).set_target({&at, 1});
  }
  /// m, of the root from the box's middle, in its axes.
  Vec3<float> on_platform() {
    return world.character(platform).model()[0].inverse() * character().model()[0].translation;
  }
  int platform = -1;
};

TEST(Behaviour, StandsOnGroundThatMoves) {
  struct Ride {
    Vec3<double> velocity;
    double turn_rate;
    bool host;
  };
  for (const Ride& ride :
       {Ride{{0.8, 0, 0}, 0, false}, Ride{{0.8, 0, 0}, 0, true}, Ride{{0, 0, 0.5}, 0, false},
        Ride{{0, 0, -0.05}, 0, true}, Ride{{0, 0, 0}, 0.5, false}}) {
    Riding body(ride.velocity, ride.turn_rate, ride.host);
    const Vec3<float> stood = body.on_platform();
    body.run(4);
    EXPECT_LT((body.on_platform() - stood).norm(), 0.03f)
        << ride.velocity.transpose() << ", host " << ride.host;
    body.push(15, kLeft);
    body.run(5);
    const Vec3<float> now = body.on_platform() - stood;
    EXPECT_LT(now.norm(), 0.5f) << ride.velocity.transpose() << ", host " << ride.host;
    EXPECT_LT(std::abs(now.z()), 0.03f) << ride.velocity.transpose() << ", host " << ride.host;
  }
}

/// Walks, and is pushed in a phase of its stride.
struct Walking : Pushed {
  Status status;
  Behaviour<float> behaviour;
  bool fell = false;

  explicit Walking(double hz = 60) : Pushed("walk"), behaviour(asset.skeleton, {}, status) {
    h = float(1 / hz);
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
      for (const BehaviourEvent& event : behaviour.events())
        fell |= event.kind == BehaviourEventKind::kFallen;
    };
  }
  /// Whether it walks on, as its clip does, so many seconds later.
  bool walks_on(double impulse, double direction, int phase, double seconds = 5) {
    run(2 + 0.14 * phase);
    push(impulse, direction);
    run(seconds);
    return !fell && behaviour.state() == BehaviourState::kClip && character().report().unknown_dofs == 0;
  }
};

TEST(Behaviour, WhoWalksCatchesItselfByItsNextSteps) {
  for (const double impulse : {10.0, 20.0, 30.0, 45.0}) {
    int caught = 0;
    for (const double direction : {0.0, kLeft, kBack, -kLeft})
      for (int phase = 0; phase < 8; ++phase) {
        Walking body;
        (void)body.walks_on(impulse, direction, phase, 3);
        caught += !body.fell;
      }
    GTEST_LOG_(INFO) << impulse << " N s: " << caught << " of 32 are caught";
    EXPECT_GE(caught, impulse < 15 ? 28 : 5);
  }
}

TEST(Behaviour, WhoWalkedOnIsOnItsAnimationWhereItWalks) {
  Walking body;
  ASSERT_TRUE(body.walks_on(10, kLeft, 0));
  const Displacement by = body.character().displacement();
  EXPECT_GT(by.y, 0.02);  // to the left, where it was pushed
  const Vec3<double> root = body.jets[0].translation.cast<double>();
  EXPECT_LT((by.turn() * root + Vec3<double>(by.x, by.y, by.z) - body.character().position()).norm(), 1e-4);
  EXPECT_GE(body.root_height(), 0.85);
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
