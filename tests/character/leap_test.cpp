// What an animation does that no body could: leaps, and bones that stretch.
#include <gtest/gtest.h>

#include <cmath>

#include "sinew/character/world.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/loop.h"

namespace sinew {
namespace {

using V = Vec3<double>;

/// A trunk, and an arm of 0.4 m that hangs from it on a ball joint.
Skeleton trunk_and_arm() {
  Skeleton s;
  for (int n = 0; n < 2; ++n) {
    Joint& joint = s.joints.emplace_back();
    joint.name = n == 0 ? "trunk" : "arm";
    joint.parent = n - 1;
    joint.type = n == 0 ? JointType::kFree : JointType::kBall;
    joint.mass = n == 0 ? 20 : 3;
    joint.inertia = Mat3<double>::Identity() * (n == 0 ? 0.5 : 0.05);
    if (n == 1) {
      joint.rest.translation = {0, 0.2, 0};
      joint.center_of_mass = {0, 0.2, 0};
      for (int k = 0; k < 3; ++k) joint.dofs[k].torque_minus = joint.dofs[k].torque_plus = 60;
    }
    Collider& body = s.colliders.emplace_back();
    body.joint = n;
    body.shape = Shape::kCapsule;
    body.size = {0.06, 0.06, 0.15};
    if (n == 1) {
      body.local.translation = {0, 0.2, 0};
      body.local.rotation = Eigen::AngleAxisd(M_PI / 2, V::UnitX());
    }
  }
  s.body_count = 2;
  return s;
}

template <class T>
struct Led {
  World<T> world{WorldSettings{}};
  std::vector<JointJet<T>> jets = std::vector<JointJet<T>>(2);

  explicit Led(double height) {
    Status status;
    EXPECT_EQ(world.add_character(trunk_and_arm(), {}, status), 0) << status.reason;
    jets[0].translation = {0, 0, T(height)};
    jets[1].translation = {0, T(0.2), 0};
    (void)figure().set_target(jets);
    (void)figure().reset();
  }
  Character<T> figure() { return world.character(0); }
  void step(double h = 1 / 60.0) {
    EXPECT_TRUE(figure().set_target(jets).ok());
    EXPECT_TRUE(world.step(T(h)).ok());
  }
};

template <class T>
class Leaps : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Leaps, Scalars);

TYPED_TEST(Leaps, TakeAlongWhatIsTied) {
  using T = TypeParam;
  for (const bool held : {false, true}) {  // by the world, too
    Led<T> led(1.5);
    Status status;
    ClothSettings cape;
    make_grid(0.3, 0.4, 4, 5, cape);
    cape.fixed = {0, 1, 2, 3};
    ParticleBody cloth = make_cloth(cape);
    cloth.frame.kind = AnchorKind::kCharacter;
    cloth.frame.frame.translation = {-0.2, 0, 0.1};
    ASSERT_EQ(led.world.add_particles(cloth, status), 0) << status.reason;
    PropSettings bag;
    bag.pose.translation = {0.3, 0, 1};
    ASSERT_EQ(led.world.add_prop(bag, status), 0);
    LoopSettings rope;
    rope.kind = LoopKind::kRope;
    rope.length = 0.6;
    rope.a.kind = AnchorKind::kCharacter;
    rope.b.kind = AnchorKind::kProp;
    ASSERT_EQ(led.world.add_loop(rope, status), 0) << status.reason;
    if (held) {
      LoopSettings nail;
      nail.a.kind = AnchorKind::kProp;
      nail.b.frame.translation = bag.pose.translation;
      ASSERT_EQ(led.world.add_loop(nail, status), 1) << status.reason;
    }
    T swings = T(0.1), flutters = T(0.1);  // m/s
    for (int n = 0; n < 90; ++n) {
      led.step();
      if (n < 30) continue;
      swings = std::max(swings, led.world.prop_velocity(0).norm());
      flutters = std::max(flutters, led.world.particle_velocity(0, 19).norm());
    }
    const auto in_trunk = [&](const Vec3<T>& point) {
      return V((led.figure().model()[0].inverse() * point).template cast<double>());
    };
    const V hem = in_trunk(led.world.particle(0, 19)), hangs = in_trunk(led.world.prop_pose(0).translation);
    const Vec3<T> before = led.world.prop_pose(0).translation;
    led.jets[0].translation += Vec3<T>(5, -3, T(0.5));
    led.jets[0].rotation = Eigen::AngleAxis<T>(T(2), Vec3<T>::UnitZ());
    led.step();
    EXPECT_TRUE(led.figure().report().carried);
    EXPECT_LT((in_trunk(led.world.particle(0, 19)) - hem).norm(), 0.01);
    if (held) {
      EXPECT_LT((led.world.prop_pose(0).translation - before).norm(), T(0.5)) << "nailed to the world";
      continue;
    }
    EXPECT_LT((in_trunk(led.world.prop_pose(0).translation) - hangs).norm(), 0.01 + swings / 60);
    for (int n = 0; n < 30; ++n) {
      led.step();
      ASSERT_LT(led.world.prop_velocity(0).norm(), T(1.2) * swings);
      ASSERT_LT(led.world.particle_velocity(0, 19).norm(), T(2) * flutters);
      ASSERT_TRUE(led.world.particle_report(0).converged);
    }
  }
}

TYPED_TEST(Leaps, BonesThatAClipStretchesStayInALimpBodyAsTheyAre) {
  using T = TypeParam;
  Led<T> led(0.4);
  led.step();
  (void)led.figure().set_root_drive(RootDrive::kFree);
  (void)led.figure().set_strength(0);
  const auto stretch = [&](double seconds) {
    led.jets[1].translation.x() = T(0.15 * std::sin(6 * seconds));
    led.jets[1].velocity.x() = T(0.9 * std::cos(6 * seconds));
  };
  for (int n = 0; n < 600; ++n) {
    stretch(n / 60.0);
    led.step();
  }
  EXPECT_LT(led.figure().report().kinetic_energy, 1e-6) << "lies still while the clip plays on";
  const auto socket = [&] {
    return V(
        (led.figure().model()[0].inverse() * led.figure().model()[1].translation).template cast<double>());
  };
  EXPECT_LT((socket() - V(0, 0.2, 0)).norm(), 1e-5);
  // With its strength it follows the clip's bones again, without a leap.
  led.jets[1].translation.x() = T(0.15);
  led.jets[1].velocity.x() = T(0);
  (void)led.figure().set_strength(1);
  V last = socket();
  double fastest = 0;
  for (int n = 0; n < 60; ++n) {
    led.step();
    fastest = std::max(fastest, (socket() - last).norm() * 60);
    last = socket();
  }
  EXPECT_LT((last - V(0.15, 0.2, 0)).norm(), 1e-5);
  EXPECT_LT(fastest, 1.1);
  EXPECT_GT(fastest, 0.1);
}

}  // namespace
}  // namespace sinew
