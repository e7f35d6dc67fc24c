// Indices and handles that name nothing, or something that was taken away: every call of a world answers with
// a reason, a null or zeros, and nothing moves.
#include <gtest/gtest.h>

#include <climits>
#include <limits>
#include <utility>

#include "character/scenes.h"
#include "sinew/effects/wind.h"

namespace sinew {
namespace {

using fixtures::Playing;

constexpr int kWrong[] = {-1, 1, 7, INT_MAX, INT_MIN};  ///< in worlds that have one of each

void expect_refused(const Status& status, int index, const char* reason) {
  EXPECT_EQ(status.code, Code::kInvalidArgument) << index;
  EXPECT_EQ(status.index, index);
  EXPECT_STREQ(status.reason, reason);
}

/// One of each kind: a character that plays, a ball, a rope between them, three beads.
struct OfEach : Playing<float> {
  OfEach() {
    Status status;
    PropSettings ball;
    ball.pose.translation = {2, 0, 1};
    EXPECT_EQ(world.add_prop(ball, status), 0) << status.reason;
    LoopSettings rope;
    rope.kind = LoopKind::kRope;
    rope.a = {AnchorKind::kProp, 0, 0, {}};
    rope.b = {AnchorKind::kWorld, 0, 0, {}};
    rope.length = 5;
    EXPECT_EQ(world.add_loop(rope, status), 0) << status.reason;
    ParticleBody beads;
    for (int n = 0; n < 3; ++n) {
      beads.nodes.push_back({});
      beads.nodes.back().position = {4, 0, 1 + 0.1 * n};
    }
    EXPECT_EQ(world.add_particles(beads, status), 0) << status.reason;
  }
};

TEST(Handles, CharacterOfAWrongIndexIsNullAndRefusesWithAReason) {
  Playing<float> scene;
  for (const int index : kWrong) {
    Character<float> nobody = scene.world.character(index);
    EXPECT_FALSE(nobody.valid()) << index;
    const std::vector<JointJet<float>> jets = fixtures::idle<float>(scene.skeleton, 0);
    const Vec3<float> at = Vec3<float>::Zero(), push(1, 0, 0);
    for (const Status& status :
         {nobody.set_target(jets), nobody.reset(), nobody.set_strength(1), nobody.set_strength(0, 1),
          nobody.set_muscle_strength(0, 1), nobody.set_group_strength("arm", 1), nobody.set_activation(1),
          nobody.set_self_collision(SelfCollision::kOn), nobody.set_root_drive(RootDrive::kFree),
          nobody.set_detail({}), nobody.apply_impulse(0, at, push), nobody.apply_force(0, at, push)})
      expect_refused(status, -1, "no such character");
  }
}

TEST(Handles, CharacterOfAWrongIndexReadsAsNothing) {
  Playing<float> scene;
  for (const int index : kWrong) {
    const Character<float> nobody = scene.world.character(index);
    for (const std::size_t size :
         {nobody.local().size(), nobody.model().size(), nobody.unknown().size(), nobody.torque().size(),
          nobody.load().size(), nobody.limit().size(), nobody.skeleton().joints.size()})
      EXPECT_EQ(size, 0u) << index;
    EXPECT_EQ(nobody.position(), Vec3<double>::Zero());
    EXPECT_EQ(nobody.muscle_torque(0), 0.f);
    EXPECT_EQ(nobody.first_dof(0), -1);
    EXPECT_FALSE(nobody.on_animation());
    EXPECT_EQ(nobody.report().dofs, 0);
    EXPECT_EQ(nobody.detail().check_every, 1);
  }
}

TEST(Handles, JointsAndMusclesOfACharacterAreChecked) {
  Playing<float> scene;
  const Character<float> hero = scene.character();
  ASSERT_TRUE(hero.valid());
  const int bodies = scene.skeleton.body_count;
  for (const int joint : {-1, bodies, INT_MAX, INT_MIN}) EXPECT_EQ(hero.first_dof(joint), -1) << joint;
  EXPECT_EQ(hero.first_dof(0), 0);
  EXPECT_LT(hero.first_dof(bodies - 1), hero.report().dofs);
  const int muscles = static_cast<int>(scene.skeleton.muscles.size());
  for (const int muscle : {-1, muscles, INT_MAX, INT_MIN}) EXPECT_EQ(hero.muscle_torque(muscle), 0.f);
}

TEST(Handles, WorldRefusesWrongIndicesOfEveryKindWithAReason) {
  OfEach scene;
  World<float>& world = scene.world;
  const Vec3<float> still = Vec3<float>::Zero();
  for (const int index : kWrong) {
    for (const Status& status : {world.park_character(index), world.unpark_character(index),
                                 world.remove_effects(index), world.add_effect(index, nullptr)})
      expect_refused(status, index, "no such character");
    for (const Status& status : {world.set_prop(index, {}, still, still), world.park_prop(index),
                                 world.add_prop_effect(index, nullptr)})
      expect_refused(status, index, "no such prop");
    expect_refused(world.set_loop(index, true), index, "no such loop");
    expect_refused(world.reset_particles(index), index, "no such particle body");
  }
}

TEST(Handles, PropsGoNowhereAndRootsAreDrivenByNothingThatIsNone) {
  OfEach scene;
  World<float>& world = scene.world;
  const Vec3<float> still = Vec3<float>::Zero();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Transform<float> nowhere;
  nowhere.translation.x() = nan;
  const Transform<float> before = world.prop_pose(0);
  for (const Status& status :
       {world.set_prop(0, nowhere, still, still), world.set_prop(0, {}, Vec3<float>(0, nan, 0), still),
        world.set_prop(0, {}, still, Vec3<float>(0, 0, nan))}) {
    EXPECT_EQ(status.code, Code::kNotFinite);
    EXPECT_EQ(status.index, 0);
  }
  EXPECT_EQ(world.prop_pose(0), before);
  PropSettings lost;
  lost.pose.translation.z() = double(nan);
  Status status;
  EXPECT_EQ(world.add_prop(lost, status), -1);
  EXPECT_EQ(status.code, Code::kNotFinite);
  EXPECT_EQ(world.prop_count(), 1);
  EXPECT_EQ(scene.character().set_root_drive(RootDrive(9)).code, Code::kInvalidArgument);
}

TEST(Handles, WorldReadsNothingAtWrongIndicesOfEveryKind) {
  OfEach scene;
  const World<float>& world = scene.world;
  const Vec3<float> zero = Vec3<float>::Zero();
  for (const int index : kWrong) {
    EXPECT_FALSE(world.parked(index));
    EXPECT_EQ(world.prop_pose(index).translation, zero);
    EXPECT_EQ(world.prop_velocity(index), zero);
    EXPECT_EQ(world.prop_report(index).dofs, 0);
    EXPECT_EQ(world.loop_gap(index), 0);
    EXPECT_EQ(world.loop_force(index), zero);
    EXPECT_EQ(world.particle(index, 0), zero);
    EXPECT_EQ(world.particle_velocity(index, 0), zero);
    EXPECT_EQ(world.particle_report(index).dofs, 0);
  }
  for (const int node : {-1, 3, INT_MAX, INT_MIN}) {
    EXPECT_EQ(world.particle(0, node), zero);
    EXPECT_EQ(world.particle_velocity(0, node), zero);
  }
  EXPECT_NE(world.particle(0, 2), zero);
}

TEST(Handles, WrongCallsMoveNothing) {
  OfEach scene, other;
  for (int n = 0; n < 20; ++n) {
    for (const int index : kWrong) {
      (void)scene.world.character(index).reset();
      (void)scene.world.set_prop(index, {}, {1, 2, 3}, {4, 5, 6});
      (void)scene.world.park_character(index);
      (void)scene.world.set_loop(index, false);
      (void)scene.world.reset_particles(index, {1, 2, 3});
      (void)scene.world.remove_effect({static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(index)});
    }
    scene.step();
    other.step();
  }
  std::vector<std::byte> state(scene.world.snapshot_capacity()), same(other.world.snapshot_capacity());
  state.resize(scene.world.save(state));
  same.resize(other.world.save(same));
  EXPECT_GT(state.size(), 0u);
  EXPECT_EQ(state, same);
}

TEST(Handles, EffectIsFoundUntilItIsTakenAway) {
  Playing<float> scene;
  EffectId first, second;
  auto made = std::make_unique<Wind<float>>(WindSettings{});
  const Effect<float>* const wind = made.get();
  ASSERT_TRUE(scene.world.add_effect(0, std::move(made), &first).ok());
  ASSERT_TRUE(scene.world.add_effect(0, std::make_unique<Wind<float>>(WindSettings{}), &second).ok());
  EXPECT_EQ(scene.world.effect(first), wind);
  EXPECT_NE(scene.world.effect(second), nullptr);
  EXPECT_NE(first, second);
  ASSERT_TRUE(scene.world.remove_effect(first).ok());
  EXPECT_EQ(scene.world.effect(first), nullptr);
  EXPECT_NE(scene.world.effect(second), nullptr);
  expect_refused(scene.world.remove_effect(first), -1, "no such effect, or it was taken away");
  ASSERT_TRUE(scene.world.remove_effects(0).ok());
  EXPECT_EQ(scene.world.effect(second), nullptr);
  scene.step();
  EXPECT_TRUE(scene.pose_is_the_targets_bits());
}

TEST(Handles, IdOfAnEffectThatIsGoneIsNeverThatOfALaterOne) {
  Playing<float> scene, elsewhere;
  std::vector<EffectId> gone;
  for (int n = 0; n < 50; ++n) {
    EffectId id;
    ASSERT_TRUE(scene.world.add_effect(0, std::make_unique<Wind<float>>(WindSettings{}), &id).ok());
    for (const EffectId& old : gone) EXPECT_EQ(scene.world.effect(old), nullptr);
    EXPECT_EQ(elsewhere.world.effect(id), nullptr) << "another world's";
    ASSERT_TRUE(scene.world.remove_effect(id).ok());
    gone.push_back(id);
  }
  EXPECT_EQ(scene.world.effect({}), nullptr);
}

TEST(Handles, RefusedEffectHasNoId) {
  Playing<float> scene;
  EffectId id{3, 4};
  EXPECT_FALSE(scene.world.add_effect(0, nullptr, &id).ok());
  EXPECT_EQ(id, EffectId{});
}

/// An effect that was taken away acts no more, and those that stay do: as if it had never been there.
TEST(Handles, RemovedEffectActsNoMoreAndTheOthersDo) {
  WindSettings gale;
  gale.velocity = {20, 0, 0};
  PropSettings ball;
  ball.pose.translation = {0, 0, 3};
  Status status;
  WorldSettings airless;
  airless.ground = false;
  World<double> two(airless), one(airless), none(airless);
  for (World<double>* world : {&two, &one, &none})
    ASSERT_EQ(world->add_prop(ball, status), 0) << status.reason;
  EffectId first, second;
  ASSERT_TRUE(two.add_prop_effect(0, std::make_unique<Wind<double>>(gale), &first).ok());
  ASSERT_TRUE(two.add_prop_effect(0, std::make_unique<Wind<double>>(gale), &second).ok());
  ASSERT_TRUE(one.add_prop_effect(0, std::make_unique<Wind<double>>(gale)).ok());
  ASSERT_TRUE(two.remove_effect(first).ok());
  for (int n = 0; n < 30; ++n)
    for (World<double>* world : {&two, &one, &none}) ASSERT_TRUE(world->step(1 / 60.0).ok());
  EXPECT_EQ(two.prop_velocity(0), one.prop_velocity(0));
  EXPECT_GT(one.prop_velocity(0).x(), none.prop_velocity(0).x() + 0.01);
  ASSERT_TRUE(two.remove_effect(second).ok());
  const double speed = two.prop_velocity(0).x();
  for (int n = 0; n < 30; ++n)
    for (World<double>* world : {&two, &one}) ASSERT_TRUE(world->step(1 / 60.0).ok());
  // The scheme carries a part of the last acceleration into one more step: 2e-3 of what the wind would do in
  // all.
  EXPECT_NEAR(two.prop_velocity(0).x(), speed, 2e-3 * (one.prop_velocity(0).x() - speed));
}

}  // namespace
}  // namespace sinew
