// One foot at a time: when it locks, where it stays, and when it is let go.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "sinew/animation/foot_placement_job.h"
#include "sinew/animation/soft_limits.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

using Vec = Vec3<double>;
using Pose = std::vector<JointJet<double>>;

static_assert(std::is_trivially_copyable_v<FootState<float>> &&
              std::is_trivially_copyable_v<FootState<double>>);

constexpr double kFrame = 1 / 60.0;  // s

/// Pelvis, thigh, shin, foot; the sole 5 cm below the ankle, the ball 15 cm in front of it.
class OneFoot : public testing::Test {
 protected:
  OneFoot() {
    leg.upper = 1;
    leg.middle = 2;
    leg.foot = 3;
    leg.toe << 0.15, 0, -0.05;
    leg.heel << -0.05, 0, -0.05;
    leg.bend = Vec::UnitX();
    job.parents = parents;
    job.legs = {&leg, 1};
    job.feet = {&input, 1};
    job.states = {&state, 1};
    job.follow = 0;  // the hip stays above
    input.under = {&hit, 1};
  }
  /// A knee that is a little bent, the sole 3 mm over a floor at 0, the root at x.
  Pose standing(double x) const {
    Pose pose(4);
    const double bend = 0.35;
    pose[0].translation << x, 0, 0.053 + 0.8 * std::cos(bend);
    pose[1].rotation = rotation_about_y(-bend);
    pose[2].translation << 0, 0, -0.4;
    pose[2].rotation = rotation_about_y(2 * bend);
    pose[3].translation << 0, 0, -0.4;
    pose[3].rotation = rotation_about_y(-bend);
    return pose;
  }
  static Quat<double> rotation_about_y(double angle) {
    return {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
  }
  /// A frame in which the animation has its root at x; the toe that comes of it, model space.
  Vec toe_at(double x, double h = kFrame) {
    jets = standing(x);
    job.jets = jets;
    job.step = h;
    status = job.Run();
    return value_of<double>(model_motion<double>(jets, parents, 3) * still<double>(leg.toe));
  }
  Vec after(int frames, double x) {
    Vec toe;
    for (int i = 0; i < frames; ++i) toe = toe_at(x);
    return toe;
  }
  std::vector<int> parents = {-1, 0, 1, 2};
  FootLeg<double> leg;
  GroundHit<double> hit;
  FootInput<double> input;
  FootState<double> state;
  FootPlacementJob<double> job;
  Pose jets;
  Status status;
};

TEST_F(OneFoot, IsTheAnimationsWhileItIsFree) {
  const Pose wanted = standing(0);
  const Vec toe = toe_at(0);
  ASSERT_TRUE(status.ok()) << status.reason;
  EXPECT_NEAR(toe.z(), 0.003, 1e-9);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(jets[i].rotation.angularDistance(wanted[i].rotation), 1e-6) << i;
    EXPECT_LT((jets[i].translation - wanted[i].translation).norm(), 1e-12) << i;
  }
}

TEST_F(OneFoot, LocksAndReleasesBetweenTwoWeights) {
  const auto hold_with = [&](double contact) {
    input.contact = contact;
    toe_at(0);
    return state.hold;
  };
  EXPECT_EQ(hold_with(0.59), FootHold::kFree);
  EXPECT_EQ(hold_with(0.61), FootHold::kToe);
  EXPECT_EQ(hold_with(0.41), FootHold::kToe) << "a weight that trembles about one half";
  EXPECT_EQ(hold_with(0.39), FootHold::kFree);
  EXPECT_EQ(hold_with(0.7), FootHold::kFree) << "not before it is back on the animation";
  for (int i = 0; i < 12; ++i) toe_at(0);
  EXPECT_EQ(state.hold, FootHold::kToe);
}

TEST_F(OneFoot, StaysOnTheGroundWhereItWasLocked) {
  input.contact = 1;
  after(10, 0);
  EXPECT_TRUE(state.at_rest());
  const Vec locked = toe_at(0);
  EXPECT_NEAR(locked.z(), 0, 1e-4) << "on the ground, and not 3 mm over it";
  EXPECT_LT((toe_at(0.15) - locked).norm(), 1e-9) << "m";
  EXPECT_TRUE(state.locked());
}

TEST_F(OneFoot, BreaksWhenTheAnimationIsTooFarAndClosesAnew) {
  input.contact = 1;
  after(10, 0);
  toe_at(0.19);
  EXPECT_TRUE(state.locked());
  const Vec before = toe_at(0.21);
  EXPECT_FALSE(state.locked()) << "0.2 m";
  EXPECT_LT((before - toe_at(0.21, 0)).norm(), 1e-12) << "nothing jumps";
  const Vec later = after(20, 0.21);
  EXPECT_TRUE(state.at_rest());
  EXPECT_NEAR(later.x(), 0.21 + 0.15, 1e-9) << "at its new place";
}

TEST_F(OneFoot, BreaksWhenTheLegIsTooShort) {
  job.settings.farthest = 10;
  job.deepest = 0.01;
  input.contact = 1;
  after(10, 0);
  ASSERT_TRUE(state.locked());
  toe_at(0.4);
  EXPECT_FALSE(state.locked());
}

TEST_F(OneFoot, LiesOnASlopeAndThePelvisComesDownForIt) {
  hit.normal = Vec(-std::tan(0.3), 0, 1).normalized();  // rises along x
  hit.point << 0, 0, -0.2;
  input.contact = 1;
  after(60, 0);
  EXPECT_LT((value_of<double>(model_motion<double>(jets, parents, 3).rotation * still<double>(Vec::UnitZ())) -
             hit.normal)
                .norm(),
            1e-9);
  EXPECT_LT(jets[0].translation.z(), standing(0)[0].translation.z() - 0.05);
  const Vec hip = jets[0].translation,
            ankle = value_of<double>(model_motion<double>(jets, parents, 3).translation);
  EXPECT_NEAR((hip - ankle).norm(), 0.995 * 0.8, 1e-3);
}

TEST_F(OneFoot, WallsAreNoGroundToLieOn) {
  hit.normal = Vec(-std::sin(1.2), 0, std::cos(1.2));  // 69 degrees
  toe_at(0);
  EXPECT_LT(state.normal[0], 1e-12);
  EXPECT_EQ(state.normal[2], 1);
}

TEST_F(OneFoot, StepsOfTheGroundFadeInWithTheirHalfLife) {
  toe_at(0);
  hit.point.z() = 0.1;
  EXPECT_NEAR(toe_at(0).z(), 0.003, 1e-9) << "nothing jumps";
  EXPECT_NEAR(toe_at(0, 0.1).z(), 0.003 + 0.05, 1e-6) << "half of it after 0.1 s";
  const GroundHit<double> ahead{{1, 0, 0.3}};
  input.ahead = {&ahead, 1};
  toe_at(0);
  EXPECT_EQ(state.point[2], 0.3) << "rises before it is there";
  input.contact = 1;
  toe_at(0);
  EXPECT_EQ(state.point[2], 0.1) << "comes down on what is under it";
}

TEST_F(OneFoot, StaysFiniteAndWithinItsLegOnAnyGround) {
  constexpr unsigned kSeed = 20261126;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> any(-1, 1);
  SmoothInput<double> drop;
  job.drop = &drop;
  MovingTransform<double> body;
  job.grounds = {&body, 1};
  for (int frame = 0; frame < 20000; ++frame) {
    if (frame % 40 == 0) input.contact = 0.5 + 0.5 * any(random);
    if (frame % 7 == 0) {
      const double steep = 1.5 * any(random), round = 3 * any(random);
      hit.normal << std::sin(steep) * std::cos(round), std::sin(steep) * std::sin(round), std::cos(steep);
      hit.point << any(random), any(random), 0.5 * any(random);
      hit.ground = any(random) < 0 ? -1 : 0;
    }
    input.under = {&hit, any(random) < 0.8 ? 1u : 0u};
    JointJet<double> jet;
    jet.rotation = rotation_exp<double>({0.1 * any(random), 0.1 * any(random), any(random)});
    jet.omega << any(random), any(random), any(random);
    jet.translation << any(random), any(random), 0.3 * any(random);
    body = moving_transform(jet);
    toe_at(any(random), any(random) < 0 ? 0 : 0.05 * (1 + any(random)));
    ASSERT_TRUE(status.ok()) << status.reason << ", frame " << frame << ", seed " << kSeed;
    for (const JointJet<double>& j : jets)
      ASSERT_TRUE(j.rotation.coeffs().allFinite() && j.alpha.allFinite() && j.acceleration.allFinite())
          << frame;
    const Vec ankle = value_of<double>(model_motion<double>(jets, parents, 3).translation);
    ASSERT_LE((ankle - jets[0].translation).norm(), 0.8 * 0.9995 + 1e-9) << frame;
  }
}

TEST_F(OneFoot, RefusesWhatCannotBeMeant) {
  toe_at(0);
  ASSERT_TRUE(status.ok());
  const auto code_of = [&](auto change) {
    const FootPlacementJob<double> old = job;
    const FootLeg<double> old_leg = leg;
    const GroundHit<double> old_hit = hit;
    const FootInput<double> old_input = input;
    change();
    const Status result = job.Run();
    job = old;
    leg = old_leg;
    hit = old_hit;
    input = old_input;
    return result.code;
  };
  EXPECT_EQ(code_of([] {}), Code::kOk);
  EXPECT_EQ(code_of([&] { leg.foot = 4; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { job.states = {}; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { job.pelvis = -1; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { hit.ground = 0; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { hit.normal *= 2; }), Code::kNotFinite);
  EXPECT_EQ(code_of([&] { hit.point.x() = NAN; }), Code::kNotFinite);
  EXPECT_EQ(code_of([&] { input.contact = 1.1; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { job.reach = 1; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { job.step = -1; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { job.settings.release_at = 0.7; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { job.level.rate = NAN; }), Code::kNotFinite);
  state.ground = 0;
  EXPECT_EQ(code_of([] {}), Code::kInvalidArgument) << "a ground that is gone";
}

TEST(FootLeg, IsFoundByRolesAndTheSoleByColliders) {
  Skeleton s;
  const auto add = [&](Role role, const Vec& at) {
    Joint joint;
    joint.role = role;
    joint.parent = int(s.joints.size()) - 1;
    joint.rest.translation = at;
    s.joints.push_back(joint);
  };
  add(Role::kPelvis, {0, 0, 1});
  add(Role::kThighR, {0, -0.1, -0.05});
  add(Role::kShinR, {0, 0, -0.4});
  add(Role::kFootR, {0, 0, -0.45});
  add(Role::kToesR, {0.14, 0, -0.06});
  Collider box;
  box.joint = 3;
  box.shape = Shape::kBox;
  box.local.translation << 0.05, 0, -0.05;
  box.size << 0.12, 0.04, 0.05;
  s.colliders.push_back(box);
  FootLeg<double> leg;
  ASSERT_TRUE(find_foot_leg(s, Role::kFootR, leg).ok());
  EXPECT_EQ(leg.upper, 1);
  EXPECT_EQ(leg.middle, 2);
  EXPECT_EQ(leg.foot, 3);
  EXPECT_LT((leg.toe - Vec(0.14, 0, -0.1)).norm(), 1e-12);
  EXPECT_LT((leg.heel - Vec(-0.07, 0, -0.1)).norm(), 1e-12);
  EXPECT_LT((leg.bend - Vec::UnitX()).norm(), 1e-12);
  EXPECT_FALSE(find_foot_leg(s, Role::kFootL, leg).ok());
  EXPECT_FALSE(find_foot_leg(s, Role::kHandL, leg).ok());
}

TEST(InContact, KnowsWindowsThatRunOverTheSeam) {
  Clip clip;
  clip.duration = 1;
  clip.loops = true;
  clip.contacts = {{3, 0.8f, 1.3f}, {4, 0.1f, 0.2f}};
  for (const double t : {0.0, 0.29, 0.81, 7.1, -0.1}) EXPECT_TRUE(in_contact(clip, t, 3)) << t;
  for (const double t : {0.31, 0.79, 5.5, -0.5}) EXPECT_FALSE(in_contact(clip, t, 3)) << t;
  EXPECT_FALSE(in_contact(clip, 0.1, 2));
  clip.loops = false;
  EXPECT_FALSE(in_contact(clip, 0.1, 3));
}

TEST(SoftLimits, AreExactAwayFromTheLimitAndNeverBeyondIt) {
  using Jet = TimeJet<double>;
  constexpr double w = 0.1;
  for (double x = -0.3; x < 0.3; x += 0.001) {
    const Jet soft = soft_positive<double>({x, 1, 0}, w);
    EXPECT_GE(soft.value, std::max(0.0, x) - 1e-15);
    EXPECT_LE(soft.value, std::max(0.0, x) + w * 3 / 16 + 1e-15);
    if (std::abs(x) >= w) {
      EXPECT_EQ(soft.value, std::max(0.0, x));
    }
  }
  EXPECT_EQ(soft_min<double>({2.0}, {3.0}, w).value, 2);
  EXPECT_EQ(soft_max<double>({2.0}, {3.0}, w).value, 3);
}

}  // namespace
}  // namespace sinew
