// What a body tells of itself, against closed forms and differences of its poses.
#include "sinew/character/physics_values.h"

#include <numbers>

#include "character/rods.h"
#include "character/scenes.h"
#include "sinew/animation/moving_transform.h"

namespace sinew {
namespace {

/// So many rods on a root 2 m up.
Skeleton figure(int rods) {
  Skeleton skeleton = fixtures::rods(rods);
  skeleton.joints[0].rest.translation = {0, 0, 2};
  return skeleton;
}

struct Scene {
  Skeleton skeleton;
  World<double> world;
  std::vector<JointJet<double>> target;

  Scene(const Skeleton& s, const CharacterSettings& settings, bool ground = false)
      : skeleton(s), world(with(ground)), target(s.joints.size()) {
    Status status;
    EXPECT_EQ(world.add_character(skeleton, settings, status), 0) << status.reason;
    for (std::size_t j = 0; j < target.size(); ++j) {
      target[j].rotation = s.joints[j].rest.rotation;
      target[j].translation = s.joints[j].rest.translation;
    }
    EXPECT_TRUE(hero().set_target(target).ok());
    EXPECT_TRUE(hero().reset().ok());
  }
  static WorldSettings with(bool ground) {
    WorldSettings settings;
    settings.ground = ground;
    return settings;
  }
  Character<double> hero() { return world.character(0); }
  void step(double h = 1 / 60.0) {
    ASSERT_TRUE(hero().set_target(target).ok());
    ASSERT_TRUE(world.step(h).ok());
  }
};

TEST(PhysicsValues, OfWhoPlaysAreThoseOfItsAnimation) {
  fixtures::Playing<float> scene;
  for (int k = 0; k < 5; ++k) scene.step();
  std::vector<float> loads(scene.skeleton.joints.size());
  const PhysicsValues<float> values = physics_values<float>(scene.character(), loads);
  EXPECT_EQ(values.off_animation, 0);
  EXPECT_EQ(values.contacts, 0) << "nothing is solved";
  EXPECT_NEAR(values.tilt, 0, 1e-3);
  EXPECT_NEAR(values.height, 1, 1e-6);
  const std::span<const float> all = scene.character().load();
  EXPECT_GT(values.load, 0);
  EXPECT_EQ(values.load, *std::max_element(all.begin(), all.end()));
  EXPECT_EQ(values.load, *std::max_element(loads.begin(), loads.end()));
  EXPECT_EQ(values.joint_load.data(), loads.data());
  const PhysicsValues<float> nobody = physics_values<float>(Character<float>(nullptr));
  EXPECT_EQ(nobody.load, 0);
  EXPECT_EQ(nobody.height, 1);
}

TEST(PhysicsValues, TiltAndFaceAreThoseOfTheRootWhereverItHeads) {
  Scene scene(figure(0), {});
  const Quat<double> heading = rotation_exp<double>(Vec3<double>(0, 0, 2));
  scene.target[0].rotation = heading * rotation_exp<double>(Vec3<double>(0, -0.7, 0));  // leans back
  scene.target[0].translation.z() = 0.5;
  EXPECT_TRUE(scene.hero().set_target(scene.target).ok());
  EXPECT_TRUE(scene.hero().reset().ok());
  scene.step();
  const PhysicsValues<double> values = physics_values<double>(scene.hero());
  EXPECT_NEAR(values.tilt, 0.7, 1e-9);
  EXPECT_NEAR(values.face_up, std::sin(0.7), 1e-9);
  EXPECT_NEAR(values.height, 0.25, 1e-9);
}

TEST(PhysicsValues, OffTheAnimationIsTheMeanDistanceOfAllMass) {
  CharacterSettings limp;
  limp.strength = 0;
  Scene scene(figure(1), limp);
  for (int k = 0; k < 20; ++k) scene.step();
  const Quat<double> turned = scene.hero().local()[1].rotation;
  const double angle = 2 * std::atan2(turned.y(), turned.w());
  EXPECT_GT(std::abs(angle), 0.3) << "it has fallen";
  const double chord = 2 * 0.5 * std::abs(std::sin(angle / 2));  // of the rod's middle
  EXPECT_NEAR(physics_values<double>(scene.hero()).off_animation, std::sqrt(2.0 / 3) * chord, 1e-6);
}

TEST(PhysicsValues, WhatLiesPressesWithItsWeight) {
  Skeleton box = figure(0);
  Collider& collider = box.colliders.emplace_back();
  collider.shape = Shape::kBox;
  collider.joint = 0;
  collider.size = Vec3<double>::Constant(0.2);
  box.joints[0].rest.translation.z() = 0.21;
  CharacterSettings limp;
  limp.strength = 0;
  limp.root = RootDrive::kFree;
  Scene scene(box, limp, true);
  for (int k = 0; k < 90; ++k) scene.step();
  const PhysicsValues<double> values = physics_values<double>(scene.hero());
  EXPECT_GE(values.contacts, 1);
  EXPECT_NEAR(values.contact_force, 1, 0.01);
}

TEST(PhysicalMotion, OfABodyThatFallsIsItsOwn) {
  // Rod and root are thrown and fall freely. Steps of 1 ms, so that differences of poses are near the truth.
  CharacterSettings limp;
  limp.strength = 0;
  limp.root = RootDrive::kFree;
  Scene scene(figure(1), limp);
  scene.target[1].omega = {0, 4, 0};
  scene.target[0].omega = {1, 0.5, 2};
  scene.target[0].velocity = {0.5, 0, 1};
  EXPECT_TRUE(scene.hero().set_target(scene.target).ok());
  EXPECT_TRUE(scene.hero().reset().ok());
  const double h = 1e-3;
  std::vector<JointJet<double>> before(2), now(2), after(2);
  for (int k = 0; k < 100; ++k) scene.step(h);
  physical_motion<double>(scene.hero(), before);
  scene.step(h);
  physical_motion<double>(scene.hero(), now);
  scene.step(h);
  physical_motion<double>(scene.hero(), after);
  for (std::size_t j = 0; j < 2; ++j) {
    SCOPED_TRACE(j);
    const Quat<double> turned = before[j].rotation.conjugate() * after[j].rotation;
    const Vec3<double> omega = turned.vec() * 2 / (2 * h);
    EXPECT_LT((now[j].omega - omega).norm(), 0.01 * (1 + omega.norm()));
    const Vec3<double> alpha = (after[j].omega - before[j].omega) / (2 * h);
    EXPECT_LT((now[j].alpha - alpha).norm(), 0.05 * (1 + alpha.norm())) << alpha.transpose();
  }
  const Vec3<double> velocity = (after[0].translation - before[0].translation) / (2 * h),
                     acceleration = (after[0].velocity - before[0].velocity) / (2 * h);
  EXPECT_LT((now[0].velocity - velocity).norm(), 0.01);
  EXPECT_LT((now[0].acceleration - acceleration).norm(), 0.05 * acceleration.norm());
  EXPECT_GT(now[1].omega.norm(), 1);
  EXPECT_GT(acceleration.norm(), 5);
}

TEST(PhysicalMotion, OfWhoPlaysIsItsAnimation) {
  fixtures::Playing<double> scene;
  for (int k = 0; k < 30; ++k) scene.step();
  std::vector<JointJet<double>> body(scene.skeleton.joints.size());
  physical_motion<double>(scene.character(), body);
  const std::vector<JointJet<double>> wanted = fixtures::idle<double>(scene.skeleton, scene.time);
  for (int j = 0; j < scene.skeleton.body_count; ++j) {
    const std::size_t k = std::size_t(j);
    EXPECT_EQ(body[k].rotation.coeffs(), wanted[k].rotation.coeffs()) << j;
    EXPECT_LT((body[k].omega - wanted[k].omega).norm(), 1e-9) << j;
    EXPECT_LT((body[k].alpha - wanted[k].alpha).norm(), 1e-7) << j;
  }
}

/// Asking changes nothing: the same bits with and without.
TEST(PhysicalMotion, AskingLeavesTheWorldAsItIs) {
  std::vector<Transform<float>> ends[2];
  for (const bool asks : {false, true}) {
    fixtures::Playing<float> scene;
    std::vector<JointJet<float>> body(scene.skeleton.joints.size());
    std::vector<float> loads(body.size());
    for (int k = 0; k < 90; ++k) {
      const int chest = scene.skeleton.find("spine");
      const Vec3<float> at(0, 0, 1.2f), push(0, 60, 0);
      const Status hit = k == 20 ? scene.character().apply_impulse(std::max(0, chest), at, push) : Status{};
      ASSERT_TRUE(hit.ok());
      scene.step();
      if (!asks) continue;
      physical_motion<float>(scene.character(), body);
      (void)physics_values<float>(scene.character(), loads);
    }
    ends[asks].assign(scene.character().local().begin(), scene.character().local().end());
  }
  for (std::size_t j = 0; j < ends[0].size(); ++j)
    EXPECT_EQ(ends[0][j].rotation.coeffs(), ends[1][j].rotation.coeffs()) << j;
}

}  // namespace
}  // namespace sinew
