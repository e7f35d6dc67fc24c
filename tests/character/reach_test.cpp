// A figure meets what it can reach in any pose, not only what it reaches at rest.
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "sinew/character/queries.h"
#include "sinew/character/world.h"

namespace sinew {
namespace {

constexpr float kStep = 1.f / 60;
constexpr int kLinks = 4;
constexpr double kLength = 0.5;  ///< m, of a link

/// Links of a carpenter's rule, folded upon each other at rest, on a base that is led.
Skeleton folded_rule() {
  Skeleton rule;
  for (int i = 0; i < kLinks; ++i) {
    Joint link;
    link.name = "link" + std::to_string(i);
    link.parent = i - 1;
    link.type = i == 0 ? JointType::kFree : JointType::kRevolute;
    link.axis = Vec3<double>::UnitY();
    if (i > 0) {
      link.rest.translation.x() = kLength;
      link.rest.rotation = rotation_exp<double>(Vec3<double>(0, std::numbers::pi, 0));
      link.dofs[0].torque_minus = link.dofs[0].torque_plus = 200;
    }
    link.mass = 2;
    link.center_of_mass.x() = kLength / 2;
    link.inertia = 0.05 * Mat3<double>::Identity();
    rule.joints.push_back(link);
    Collider rod;
    rod.shape = Shape::kCapsule;
    rod.joint = i;
    rod.size = {0.03, 0, kLength / 2};
    rod.local.translation.x() = kLength / 2;
    rod.local.rotation = rotation_exp<double>(Vec3<double>(0, std::numbers::pi / 2, 0));
    rule.colliders.push_back(rod);
  }
  rule.body_count = kLinks;
  return rule;
}

/// Unfolded, along x at a height of 1 m.
struct Unfolded {
  Skeleton rule = folded_rule();
  World<float> world{WorldSettings{}};
  std::vector<JointJet<float>> jets;

  Unfolded() : jets(rule.joints.size()) {
    Status status;
    EXPECT_EQ(world.add_character(rule, {}, status), 0) << status.reason;
    for (int i = 1; i < kLinks; ++i) jets[i].translation.x() = float(kLength);
    jets[0].translation.z() = 1;
    EXPECT_TRUE(world.character(0).set_target(jets));
    EXPECT_TRUE(world.character(0).reset());
  }
  void step() {
    EXPECT_TRUE(world.character(0).set_target(jets));
    EXPECT_TRUE(world.step(kStep));
  }
};

TEST(Reach, WhatFallsOnAStretchedArmLiesOnIt) {
  Unfolded scene;
  PropSettings ball;
  ball.size = Vec3<double>::Constant(0.1);
  ball.mass = 0.5;
  ball.pose.translation = {kLinks * kLength - 0.1, 0, 1.15};
  Status status;
  ASSERT_EQ(scene.world.add_prop(ball, status), 0) << status.reason;
  for (int n = 0; n < 30; ++n) scene.step();
  EXPECT_GT(scene.world.prop_pose(0).translation.z(), 1.1f) << "where it would have fallen by 1.2 m";
}

TEST(Reach, AStretchedArmIsSolvedForWhereAnObstacleIsInItsWay) {
  Unfolded scene;
  Collider wall;
  wall.shape = Shape::kBox;
  wall.size = {0.3, 0.3, 0.3};
  wall.local.translation = {kLinks * kLength, 0.6, 1};
  ASSERT_TRUE(scene.world.add_obstacle(wall));
  bool solved = false;
  for (int n = 0; n < 40; ++n) {  // the base turns it into the wall
    scene.jets[0].rotation = rotation_exp<float>(Vec3<float>(0, 0, 0.01f * float(n)));
    scene.jets[0].omega.z() = 0.6f;
    scene.step();
    solved = solved || scene.world.character(0).report().contacts > 0;
  }
  EXPECT_TRUE(solved);
}

TEST(Reach, ARayMeetsTheEndOfAStretchedArm) {
  Unfolded scene;
  Cast ray;
  ray.from = {kLinks * kLength - 0.1, 0, 3};
  ray.motion = {0, 0, -3};
  ray.filter.ground = false;
  std::array<QueryHit, 1> hit;
  int count = 0;
  ASSERT_TRUE(cast(scene.world, ray, hit, count));
  ASSERT_EQ(count, 1);
  EXPECT_EQ(hit[0].body.joint, kLinks - 1);
}

}  // namespace
}  // namespace sinew
