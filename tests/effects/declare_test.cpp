// Worlds that begin with nothing: what is declared acts as it does in a standard world, what is not does not.
#include <cstring>
#include <limits>

#include "character/scenes.h"
#include "sinew/character/contacts.h"
#include "sinew/effects/impulse.h"
#include "sinew/effects/joint_damping.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/effects/muscle.h"
#include "sinew/effects/support.h"

namespace sinew {
namespace {

constexpr float kStep = 1 / 60.f;

WorldSettings airborne() {
  WorldSettings settings;
  settings.ground = false;
  return settings;
}

/// Every joint bends up to a limit, with friction and damping.
Skeleton hindered() {
  Skeleton s = fixtures::humanoid();
  for (Joint& joint : s.joints)
    for (int k = 0; k < 3; ++k) {
      if (joint.type == JointType::kFree) continue;
      if (joint.type == JointType::kBall) joint.swing_limit = 0.4;
      joint.dofs[k].lower = -0.2;
      joint.dofs[k].upper = 0.2;
      joint.dofs[k].damping = 2;
      joint.dofs[k].dry_friction = 0.5;
    }
  return s;
}

/// So many of them in a row, far from each other.
void add(World<float>& world, const Skeleton& body, double strength, int count = 1) {
  for (int n = 0; n < count; ++n) {
    Status status;
    CharacterSettings settings;
    settings.strength = strength;
    settings.root = strength > 0 ? RootDrive::kKinematic : RootDrive::kFree;
    ASSERT_EQ(world.add_character(body, settings, status), n) << status.reason;
    auto jets = fixtures::idle<float>(body, 0);
    jets[0].translation += Vec3<float>(5 * float(n), 0, 10);
    for (JointJet<float>& jet : jets) jet.omega += Vec3<float>(1, float(n) / 8, -1);
    ASSERT_TRUE(world.character(n).set_target(jets).ok());
    (void)world.character(n).reset();
  }
}

std::vector<std::byte> saved(const World<float>& world) {
  std::vector<std::byte> bytes(world.snapshot_capacity());
  bytes.resize(world.save(bytes));
  return bytes;
}

void run(World<float>& world, int steps) {
  for (int n = 0; n < steps; ++n) {
    const Status status = world.step(kStep);
    ASSERT_TRUE(status.ok()) << status.reason;
  }
}

TEST(Declare, AllOfThemAreTheStandardWorldToTheBit) {
  for (const double strength : {0.0, 0.05}) {
    World<float> standard(airborne()), chosen(airborne(), DeclareNothing{});
    EXPECT_TRUE(chosen.declare<Muscles>().ok());
    EXPECT_TRUE(chosen.declare<JointLimits>().ok());
    EXPECT_TRUE(chosen.declare<JointDamping>().ok());
    EXPECT_TRUE(chosen.declare<Impulses>().ok());
    EXPECT_TRUE(chosen.declare<Contacts>().ok());
    EXPECT_TRUE(chosen.declare<Support>().ok());
    for (World<float>* world : {&standard, &chosen}) {
      add(*world, hindered(), strength, 8);
      Character<float> hit = world->character(3);
      EXPECT_TRUE(hit.apply_impulse(5, hit.model()[5].translation, {20, 5, 0}).ok());
      run(*world, 30);
    }
    EXPECT_EQ(saved(standard), saved(chosen)) << strength;
  }
}

TEST(Declare, WhatIsNotDeclaredIsAsIfTheSkeletonHadNone) {
  Skeleton unlimited = hindered(), undamped = hindered();
  for (Joint& joint : unlimited.joints) {
    joint.swing_limit = -1;
    for (DofLimits& dof : joint.dofs) dof.lower = -(dof.upper = DofLimits().upper);
  }
  for (Joint& joint : undamped.joints)
    for (DofLimits& dof : joint.dofs) dof.damping = dof.dry_friction = 0;
  World<float> without_limits(airborne(), DeclareNothing{}), without_damping(airborne(), DeclareNothing{});
  EXPECT_TRUE(without_limits.declare<JointDamping>().ok());
  EXPECT_TRUE(without_damping.declare<JointLimits>().ok());
  World<float> never_limited(airborne()), never_damped(airborne()), all(airborne());
  add(without_limits, hindered(), 0);
  add(without_damping, hindered(), 0);
  add(never_limited, unlimited, 0);
  add(never_damped, undamped, 0);
  add(all, hindered(), 0);
  const auto pose = [](World<float>& world) {
    run(world, 60);
    std::vector<float> numbers;
    for (const Transform<float>& local : world.character(0).local())
      numbers.insert(numbers.end(), local.rotation.coeffs().begin(), local.rotation.coeffs().end());
    return numbers;
  };
  const auto hindered_pose = pose(all);
  EXPECT_EQ(pose(without_limits), pose(never_limited));
  EXPECT_NE(pose(without_limits), hindered_pose);
  EXPECT_EQ(pose(without_damping), pose(never_damped));
  EXPECT_NE(pose(without_damping), hindered_pose);
}

TEST(Declare, CharacterThatNeedsMusclesIsRefusedWhereNoneAreDeclared) {
  World<float> world(airborne(), DeclareNothing{});
  Status status;
  EXPECT_EQ(world.add_character(fixtures::humanoid(), {}, status), -1);
  EXPECT_NE(std::strstr(status.reason, "Muscles"), nullptr) << status.reason;
  EXPECT_EQ(world.character_count(), 0);
  CharacterSettings boundless;
  boundless.strength = std::numeric_limits<double>::infinity();
  ASSERT_EQ(world.add_character(fixtures::humanoid(), boundless, status), 0) << status.reason;
  EXPECT_TRUE(world.step(kStep).ok());
  // Nor does it go limp later on.
  EXPECT_TRUE(world.character(0).set_strength(0.5f).ok());
  const auto before = saved(world);
  status = world.step(kStep);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(std::strstr(status.reason, "Muscles"), nullptr) << status.reason;
  EXPECT_EQ(saved(world), before);
  EXPECT_TRUE(world.character(0).set_strength(0).ok());
  EXPECT_TRUE(world.step(kStep).ok());
}

TEST(Declare, BoundlessCharacterPlaysItsAnimationWithoutMuscles) {
  World<float> world(airborne(), DeclareNothing{}), standard(airborne());
  for (World<float>* w : {&world, &standard}) {
    add(*w, fixtures::humanoid(), std::numeric_limits<double>::infinity());
    run(*w, 5);
    EXPECT_TRUE(w->character(0).on_animation());
  }
  const std::span<const float> one = world.character(0).torque(), two = standard.character(0).torque();
  EXPECT_TRUE(std::equal(one.begin(), one.end(), two.begin(), two.end()));  // airborne: no support in either
}

TEST(Declare, PushIsRefusedWhereNoImpulsesAreDeclared) {
  World<float> world(airborne(), DeclareNothing{});
  add(world, fixtures::humanoid(), 0);
  const Status status = world.character(0).apply_impulse(0, {0, 0, 1}, {1, 0, 0});
  EXPECT_FALSE(status.ok());
  EXPECT_NE(std::strstr(status.reason, "Impulses"), nullptr) << status.reason;
}

TEST(Declare, FloorAndObstaclesAreRefusedWhereNoContactsAreDeclared) {
  World<float> floor(WorldSettings{}, DeclareNothing{}), world(airborne(), DeclareNothing{});
  CharacterSettings limp;
  limp.strength = 0;
  Status status;
  EXPECT_EQ(floor.add_character(fixtures::humanoid(), limp, status), -1);
  EXPECT_NE(std::strstr(status.reason, "Contacts"), nullptr) << status.reason;
  EXPECT_FALSE(world.add_obstacle(Collider{}).ok());
  // Nor do two of them meet.
  add(world, fixtures::humanoid(), 0, 2);
  auto jets = fixtures::idle<float>(fixtures::humanoid(), 0);
  for (int n = 0; n < 2; ++n) {
    ASSERT_TRUE(world.character(n).set_target(jets).ok());
    (void)world.character(n).reset();
  }
  run(world, 5);
  EXPECT_EQ(world.character(0).report().contacts, 0);
  EXPECT_EQ(world.character(0).report().unknown_dofs, world.character(0).report().dofs);
}

TEST(Declare, TermsComeBeforeTheFirstCharacter) {
  World<float> world(airborne(), DeclareNothing{});
  add(world, fixtures::humanoid(), 0);
  EXPECT_FALSE(world.declare<JointLimits>().ok());
}

}  // namespace
}  // namespace sinew
