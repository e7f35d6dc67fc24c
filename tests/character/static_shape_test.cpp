// Height fields, convex solids and the host's own shapes as obstacles.
#include "sinew/effects/static_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sinew/character/world.h"
#include "sinew/effects/continuous_detection.h"

namespace sinew {
namespace {

using V = Vec3<double>;

HeightField hills() {
  std::vector<double> heights;
  for (int row = 0; row < 21; ++row)
    for (int column = 0; column < 31; ++column)
      heights.push_back(0.2 * std::sin(0.5 * column) * std::cos(0.4 * row));
  return {heights, 31, {-3, -2, 0.5}, 0.2};
}

TEST(HeightField, MeetsItsSamplesAndItsSlopesAreItsDerivatives) {
  const HeightField field = hills();
  double x = 0, y = 0;
  EXPECT_NEAR(field.height(-3 + 0.2 * 7, -2 + 0.2 * 4, x, y), 0.5 + 0.2 * std::sin(3.5) * std::cos(1.6),
              1e-12);
  for (const V& at : {V(0.03, 0.11, 0), V(-2.95, -1.99, 0), V(2.9, 1.7, 0), V(-1.2, 0.4, 0)}) {
    double by_x = 0, by_y = 0;
    field.height(at.x(), at.y(), by_x, by_y);
    const double d = 1e-6;
    EXPECT_NEAR(by_x,
                (field.height(at.x() + d, at.y(), x, y) - field.height(at.x() - d, at.y(), x, y)) / (2 * d),
                1e-6);
    EXPECT_NEAR(by_y,
                (field.height(at.x(), at.y() + d, x, y) - field.height(at.x(), at.y() - d, x, y)) / (2 * d),
                1e-6);
  }
  EXPECT_EQ(field.height(50, 0, x, y), field.height(3, 0, x, y)) << "the border goes on";
}

/// A floor that only the host knows.
class HostFloor final : public StaticShape {
 public:
  explicit HostFloor(double height) : height_(height) {}
  SignedDistance<double> distance(const V& point) const noexcept override {
    SignedDistance<double> d;
    d.distance = point.z() - height_;
    return d;
  }

 private:
  double height_;
};

WorldSettings without_floor() {
  WorldSettings settings;
  settings.ground = false;
  return settings;
}

PropSettings ball(const V& position, const V& velocity = V::Zero()) {
  PropSettings p;
  p.pose.translation = position;
  p.velocity = velocity;
  return p;
}

template <class T>
class StaticShapes : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(StaticShapes, Scalars);

TYPED_TEST(StaticShapes, HostsFloorBearsAsTheWorldsOwn) {
  using T = TypeParam;
  const HostFloor floor(0.25);
  WorldSettings own;
  own.ground_height = 0.25;
  World<T> host_world(without_floor()), own_world(own);
  Status status;
  ASSERT_TRUE(host_world.add_obstacle(floor, 1.0).ok());
  PropSettings prop = ball({0.1, 0, 0.6}, {1, 0, 0});
  prop.friction = 1;  // √(1 · 1), as own: 1 · ground_friction
  ASSERT_EQ(host_world.add_prop(prop, status), 0);
  ASSERT_EQ(own_world.add_prop(prop, status), 0);
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(host_world.step(T(1) / 60).ok());
    ASSERT_TRUE(own_world.step(T(1) / 60).ok());
  }
  EXPECT_LT((host_world.prop_pose(0).translation - own_world.prop_pose(0).translation).norm(), T(1e-4));
}

TYPED_TEST(StaticShapes, BoxComesToRestOnASlopeThatABallRollsDown) {
  using T = TypeParam;
  const HeightField field = hills();
  World<T> world(without_floor());
  ASSERT_TRUE(world.add_obstacle(field).ok());
  Status status;
  PropSettings box = ball({-1.9, 0.1, 0.9});
  box.shape = Shape::kBox;
  box.friction = 1;
  ASSERT_EQ(world.add_prop(ball({0.4, 0.1, 1.2}), status), 0);
  ASSERT_EQ(world.add_prop(box, status), 1);
  for (int n = 0; n < 600; ++n) ASSERT_TRUE(world.step(T(1) / 60).ok());
  for (const int prop : {0, 1}) {
    const V at = world.prop_pose(prop).translation.template cast<double>();
    double by_x = 0, by_y = 0;
    const double ground = field.height(at.x(), at.y(), by_x, by_y);
    EXPECT_NEAR((at.z() - ground) / std::sqrt(1 + by_x * by_x + by_y * by_y), 0.1, prop == 0 ? 2e-3 : 0.02)
        << prop;
  }
  EXPECT_LT(world.prop_velocity(1).norm(), T(0.01));
  EXPECT_GT((world.prop_pose(0).translation - Vec3<T>(T(0.4), T(0.1), T(1.2))).norm(), T(0.5));
}

TYPED_TEST(StaticShapes, ConvexRampIsSlidDownAndNotPassedAtSpeed) {
  using T = TypeParam;
  const double tilt = 0.5;
  const V up(std::sin(tilt), 0, std::cos(tilt));
  const ConvexSolid::Face faces[] = {{up, 0}, {-up, 0.02}};  // a plate 2 cm thick
  const ConvexSolid plate(faces, 0.01);
  for (const double speed : {0.0, 40.0}) {
    World<T> world(without_floor());
    ASSERT_TRUE(world.add_obstacle(plate, 0).ok());
    ASSERT_TRUE(world.template declare<ContinuousDetection>().ok());
    Status status;
    ASSERT_EQ(world.add_prop(ball(0.9 * up, -speed * up), status), 0);
    double deepest = 1;
    for (int n = 0; n < 60; ++n) {
      ASSERT_TRUE(world.step(T(1) / 60).ok());
      deepest = std::min(deepest, up.dot(world.prop_pose(0).translation.template cast<double>()));
    }
    EXPECT_GT(deepest, 0.08) << "speed " << speed;
    EXPECT_GT(world.prop_velocity(0).x(), T(1)) << "slides";
  }
}

TEST(StaticShape, WhatIsNoDistanceIsRefused) {
  class Broken final : public StaticShape {
   public:
    SignedDistance<double> distance(const V&) const noexcept override {
      SignedDistance<double> d;
      d.distance = std::nan("");
      return d;
    }
  };
  World<float> world({});
  const Broken broken;
  EXPECT_EQ(world.add_obstacle(broken).code, Code::kInvalidArgument);
  const HostFloor floor(0);
  EXPECT_EQ(world.add_obstacle(floor, -1).code, Code::kInvalidArgument);
}

}  // namespace
}  // namespace sinew
