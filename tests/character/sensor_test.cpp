// Sensors: who comes in and who leaves is told once.
#include "sinew/character/sensor.h"

#include <algorithm>
#include <limits>

#include "character/scenes.h"
#include "fixtures/counting_new.h"

namespace sinew {
namespace {

constexpr float kStep = 1 / 60.f;

/// A ball that falls from 3 m past a sensor at 1.5 m.
struct Falling {
  World<float> world{WorldSettings{}};
  Sensor<float> sensor{4};

  Falling() {
    PropSettings ball;
    ball.pose.translation.z() = 3;
    Status status;
    EXPECT_EQ(world.add_prop(ball, status), 0) << status.reason;
    sensor.shape.from.z() = 1.5;
    sensor.shape.radius = 0.3;
  }
  float height() const { return world.prop_pose(0).translation.z(); }
  void frame() {
    ASSERT_TRUE(world.step(kStep));
    ASSERT_TRUE(sensor.update(world));
  }
};

constexpr BodyRef kBall{BodyKind::kProp, 0, 0};

TEST(Sensor, TellsWhoComesInAndWhoLeavesOnceWhenTheyTouchIt) {
  Falling scene;
  int begins = 0, ends = 0;
  for (int frame = 0; frame < 90; ++frame) {
    scene.frame();
    const bool inside = std::abs(scene.height() - 1.5f) < 0.4f;  // a ball of 0.1 m
    EXPECT_EQ(scene.sensor.bodies().size(), inside ? 1u : 0u) << scene.height();
    for (const SensorEvent& event : scene.sensor.events()) {
      EXPECT_EQ(event.body, kBall);
      EXPECT_EQ(event.phase == ContactPhase::kBegin, inside);
      ++(event.phase == ContactPhase::kBegin ? begins : ends);
    }
  }
  EXPECT_EQ(begins, 1);
  EXPECT_EQ(ends, 1);
}

TEST(Sensor, ChangesNothingForWhoPassesThrough) {
  Falling watched;
  Falling alone;
  for (int frame = 0; frame < 60; ++frame) {
    watched.frame();
    ASSERT_TRUE(alone.world.step(kStep));
    ASSERT_EQ(watched.height(), alone.height());
  }
}

TEST(Sensor, WhoIsParkedHasLeftAndWhatMovesIsTheSensorsToo) {
  Falling scene;
  scene.sensor.shape.from.z() = 3;
  scene.frame();
  ASSERT_EQ(scene.sensor.bodies().size(), 1u);
  ASSERT_TRUE(scene.world.park_prop(0));
  ASSERT_TRUE(scene.sensor.update(scene.world));
  ASSERT_EQ(scene.sensor.events().size(), 1u);
  EXPECT_EQ(scene.sensor.events()[0], (SensorEvent{ContactPhase::kEnd, kBall}));
  Transform<float> aside;
  aside.translation = {5, 0, 0.1f};
  ASSERT_TRUE(scene.world.set_prop(0, aside, Vec3<float>::Zero(), Vec3<float>::Zero()));
  scene.frame();
  EXPECT_TRUE(scene.sensor.events().empty());
  scene.sensor.shape.from = {5, 0, 0.1};
  scene.frame();
  ASSERT_EQ(scene.sensor.events().size(), 1u);
  EXPECT_EQ(scene.sensor.events()[0], (SensorEvent{ContactPhase::kBegin, kBall}));
}

TEST(Sensor, ACharacterIsOneBodyAndTheFilterChooses) {
  World<float> world{WorldSettings{}};
  Status status;
  CharacterSettings settings;
  settings.layers = 2;
  ASSERT_EQ(world.add_character(fixtures::humanoid(), settings, status), 0) << status.reason;
  Sensor<float> all(4);
  all.shape.radius = 3;
  ASSERT_TRUE(all.update(world));
  ASSERT_EQ(all.bodies().size(), 1u) << "by many colliders";
  EXPECT_EQ(all.bodies()[0], (BodyRef{BodyKind::kCharacter, 0, 0}));
  all.shape.filter.layers = 4;
  ASSERT_TRUE(all.update(world));
  EXPECT_EQ(all.bodies().size(), 0u);
  all.shape.filter.layers = 2;
  all.shape.filter.ground = true;
  ASSERT_TRUE(all.update(world));
  EXPECT_EQ(all.bodies().size(), 1u) << "the ground has the first layer";
  all.shape.filter.accept = [](void*, const BodyRef&) { return false; };
  ASSERT_TRUE(all.update(world));
  ASSERT_EQ(all.events().size(), 1u);
  EXPECT_EQ(all.events()[0].phase, ContactPhase::kEnd);
}

TEST(Sensor, WhatFindsNoRoomIsCounted) {
  World<float> world{WorldSettings{}};
  Status status;
  for (int n = 0; n < 3; ++n) {
    PropSettings ball;
    ball.pose.translation = {0.3 * n, 0, 1};
    ASSERT_EQ(world.add_prop(ball, status), n);
  }
  Sensor<float> sensor(2);
  sensor.shape.from.z() = 1;
  sensor.shape.radius = 2;
  ASSERT_TRUE(sensor.update(world));
  EXPECT_EQ(sensor.bodies().size(), 2u);
  EXPECT_EQ(sensor.left_out(), 1);
  ASSERT_EQ(world.add_character(fixtures::humanoid(), {}, status), 0) << status.reason;
  Sensor<float> small(0);
  small.shape.radius = 3;
  ASSERT_TRUE(small.update(world));
  EXPECT_EQ(small.left_out(), 4) << "a body with many colliders is one";
}

TEST(Sensor, WhatMeansNothingIsRefusedAndChangesNothing) {
  Falling scene;
  scene.sensor.shape.from.z() = 3;
  scene.frame();
  scene.sensor.shape.radius = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(scene.sensor.update(scene.world).code, Code::kNotFinite);
  EXPECT_EQ(scene.sensor.bodies().size(), 1u);
  EXPECT_EQ(scene.sensor.events().size(), 1u);
  scene.sensor.shape.radius = -1;
  EXPECT_EQ(scene.sensor.update(scene.world).code, Code::kInvalidArgument);
}

TEST(Sensor, TakesNoMemoryFromTheHeap) {
  Falling scene;
  scene.sensor.shape.radius = 1.4;
  const long before = fixtures::allocations;
  for (int frame = 0; frame < 60; ++frame) scene.frame();
  EXPECT_EQ(fixtures::allocations - before, 0);
}

}  // namespace
}  // namespace sinew
