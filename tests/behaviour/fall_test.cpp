// Who falls reaches for the ground with his arms, and lets go when they are there.
#include <algorithm>
#include <limits>

#include "pushed.h"

namespace sinew {
namespace {

using fixtures::Pushed;

constexpr double kQuarter = 1.57079632679489661923;

/// Stands, and is pushed over.
struct Falling : Pushed {
  Status status;
  Behaviour<float> behaviour;
  double hand = -1, hit = 0;  ///< s, when a wrist comes down first; m/s, of the head when it does

  explicit Falling(const BehaviourSettings& settings = {}, double hz = 60, bool self_collision = false)
      : Pushed("stand", RootDrive::kGrounded, 0, self_collision),
        behaviour(asset.skeleton, settings, status) {
    EXPECT_TRUE(status) << status.reason;
    h = float(1 / hz);
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
    };
  }
  double height(Role role) { return double(place(role).z()); }
  Vec3<float> place(Role role) {
    return character().model()[static_cast<std::size_t>(asset.skeleton.find(role))].translation;
  }
  /// Until it lies; so hard that no step catches it.
  void falls(double impulse, double direction) {
    run(0.3);
    push(impulse, direction);
    Vec3<float> head = place(Role::kHead);
    for (const int end = frame + static_cast<int>(5 / double(h)); frame < end;) {
      step();
      const Vec3<float> now = place(Role::kHead);
      if (hand < 0 && std::min(height(Role::kHandL), height(Role::kHandR)) < 0.08) hand = time();
      if (now.z() < 0.2f && hit == 0) hit = double((now - head).norm() / h);
      head = now;
    }
    EXPECT_TRUE(behaviour.fallen()) << impulse << " N s, " << direction;
  }
  /// N·m, of all joints: what muscles can do now.
  double strongest(const Character<float>& of) {
    double most = 0;
    for (int dof = 6; dof < static_cast<int>(of.limit().size()); ++dof)
      most = std::max(most, double(of.limit()[static_cast<std::size_t>(dof)]));
    return most;
  }
};

class Falls : public testing::TestWithParam<double> {};

TEST_P(Falls, HandsAreThereFirstAndTheHeadComesDownSlower) {
  BehaviourSettings unconscious;
  unconscious.reach_strength = 0;
  double with = 0, without = 0;
  for (const double impulse : {90., 120.})
    for (int n = 0; n < 8; ++n) {
      Falling reaches({}, GetParam()), hangs(unconscious, GetParam());
      reaches.falls(impulse, n * kQuarter / 2);
      hangs.falls(impulse, n * kQuarter / 2);
      EXPECT_GT(reaches.hand, 0) << n;
      with += reaches.hit;
      without += hangs.hit;
    }
  EXPECT_LT(with, 0.8 * without) << "m/s, of heads";
}

INSTANTIATE_TEST_SUITE_P(Rates, Falls, testing::Values(30., 60., 120.));

TEST(Fall, MusclesLetGoAndStrengthsStayTheHosts) {
  Falling body;
  ASSERT_TRUE(body.character().set_strength(0.8f));
  ASSERT_TRUE(body.character().set_strength(body.asset.skeleton.find(Role::kUpperArmL), 0.5f));
  body.run(0.1);
  const double before = body.strongest(body.character());
  body.falls(120, 0);
  EXPECT_NEAR(body.strongest(body.character()), 0.02 * before, 1e-3 * before);
  EXPECT_EQ(body.character().strength(), 0.8f);
  body.behaviour.stand(body.character());
  (void)body.character().reset();
  body.run(0.1);
  EXPECT_NEAR(body.strongest(body.character()), before, 1e-3 * before);
}

TEST(Fall, WhoHasNoArmsLetsGoAtOnce) {
  Falling body;
  Skeleton skeleton = body.asset.skeleton;
  for (Joint& joint : skeleton.joints)
    if (joint.role == Role::kForearmR) joint.role = Role::kNone;
  Status status;
  Behaviour<float> armless(skeleton, {}, status);
  ASSERT_TRUE(status) << status.reason;
  body.behave = [&](std::span<JointJet<float>> wanted) {
    EXPECT_TRUE(armless.update(body.character(), wanted, body.h));
  };
  body.run(0.1);
  const double before = body.strongest(body.character());
  armless.knock_down(body.character());
  body.run(0.2);
  EXPECT_NEAR(body.strongest(body.character()), 0.02 * before, 1e-3 * before);
}

/// Thighs that lie on each other, hands on the trunk: as of a character that always meets itself.
TEST(Fall, WhoLiesMeetsItself) {
  Falling asked({}, 60, true), by_itself, never;
  for (Falling* body : {&asked, &by_itself, &never}) {
    body->run(0.3);
    body->behaviour.knock_down(body->character());
    if (body == &never)
      body->behave = [&](std::span<JointJet<float>> wanted) {
        EXPECT_TRUE(never.behaviour.update(never.character(), wanted, never.h));
        EXPECT_TRUE(never.character().set_self_collision(SelfCollision::kOff));
      };
    body->push(120, 1);
    body->run(4);
  }
  const auto off = [&](Falling& body) {  // m, the furthest joint
    float most = 0;
    for (std::size_t joint = 0; joint < asked.character().model().size(); ++joint)
      most = std::max(
          most, (asked.character().model()[joint].translation - body.character().model()[joint].translation)
                    .norm());
    return most;
  };
  EXPECT_EQ(off(by_itself), 0);
  EXPECT_GT(off(never), 0.01f);
  by_itself.behaviour.stand(by_itself.character());
  never.behaviour.stand(never.character());
  for (Falling* body : {&by_itself, &never}) {
    (void)body->character().reset();
    body->run(0.1);
  }
  EXPECT_EQ((by_itself.place(Role::kHandL) - never.place(Role::kHandL)).norm(), 0) << "as the host has it";
}

TEST(Fall, RefusesSharesThatAreNone) {
  const Asset asset = Falling().asset;
  for (const double share : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    BehaviourSettings strong, limp;
    strong.reach_strength = share;
    limp.fallen_strength = share;
    for (const BehaviourSettings& settings : {strong, limp}) {
      Status status;
      const Behaviour<float> behaviour(asset.skeleton, settings, status);
      EXPECT_EQ(status.code, Code::kInvalidArgument) << share;
    }
  }
}

}  // namespace
}  // namespace sinew
