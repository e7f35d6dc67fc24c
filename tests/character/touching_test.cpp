// Whether colliders touch on their ways, and who is stepped together for it.
#include "sinew/character/touching.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace sinew {
namespace {

using V = Vec3<double>;

Collider shape(Shape of, const V& size) {
  Collider collider;
  collider.shape = of;
  collider.size = size;
  return collider;
}

PlacedCollider<double> placed(const Collider& collider, const V& place,
                              const Quat<double>& rotation = Quat<double>::Identity()) {
  return {&collider, {rotation, place}, bounding_radius(collider)};
}

bool touch(const std::vector<PlacedCollider<double>>& a, const std::vector<PlacedCollider<double>>& b) {
  return touch_on_the_way<double>({std::span(a).first(1), std::span(a).last(1)},
                                  {std::span(b).first(1), std::span(b).last(1)}, 0);
}

const Collider kBall = shape(Shape::kSphere, {0.1, 0, 0}), kRod = shape(Shape::kCapsule, {0.02, 0, 0.5}),
               kBox = shape(Shape::kBox, {0.1, 0.2, 0.3});

TEST(Touching, BallsThatCrossEachOthersWaysTouchOnlyWhereTheyMeet) {
  // At the ends of the step they are 1.4 m apart.
  const std::vector<PlacedCollider<double>> east = {placed(kBall, {-0.5, 0, 0}), placed(kBall, {0.5, 0, 0})};
  EXPECT_TRUE(touch(east, {placed(kBall, {0, -0.5, 0}), placed(kBall, {0, 0.5, 0})}));
  EXPECT_FALSE(touch(east, {placed(kBall, {0, -1, 0}), placed(kBall, {0, 0, 0})})) << "passes behind";
  EXPECT_FALSE(touch(east, {placed(kBall, {0, -0.5, 0.21}), placed(kBall, {0, 0.5, 0.21})}))
      << "passes above";
  EXPECT_TRUE(touch(east, {placed(kBall, {0, -0.5, 0.19}), placed(kBall, {0, 0.5, 0.19})}));
}

TEST(Touching, WhatMovesAlongTogetherDoesNotTouch) {
  const V far(30, 0, 0), beside(0, 0.201, 0);
  EXPECT_FALSE(touch({placed(kBall, V::Zero()), placed(kBall, far)},
                     {placed(kBall, beside), placed(kBall, far + beside)}));
}

TEST(Touching, ARodThatTurnsSweepsWhatIsBetweenItsEnds) {
  const auto turned = [](double angle) { return Quat<double>(Eigen::AngleAxisd(angle, V::UnitY())); };
  const std::vector<PlacedCollider<double>> rod = {placed(kRod, V::Zero(), turned(0)),
                                                   placed(kRod, V::Zero(), turned(2.0))};
  const V within = turned(1.0) * V(0, 0, 0.45), beyond = turned(1.0) * V(0, 0, 0.7),
          after = turned(2.6) * V(0, 0, 0.45);
  EXPECT_TRUE(touch(rod, {placed(kBall, within), placed(kBall, within)}));
  EXPECT_FALSE(touch(rod, {placed(kBall, beyond), placed(kBall, beyond)}));
  EXPECT_FALSE(touch(rod, {placed(kBall, after), placed(kBall, after)}));
}

TEST(Touching, BoxesAreApartByTheAxisThatSeparatesThemBest) {
  // Face to face, and edge across edge.
  const PlacedCollider<double> box = placed(kBox, V::Zero());
  EXPECT_NEAR(distance_between(placed(kBox, {0.25, 0.1, 0.1}), box).distance, 0.05, 1e-12);
  const Collider plank = shape(Shape::kBox, {0.05, 0.05, 1});
  const Quat<double> edge(Eigen::AngleAxisd(std::numbers::pi / 4, V::UnitZ())),
      across = Quat<double>(Eigen::AngleAxisd(std::numbers::pi / 2, V::UnitY())) * edge;
  const double height = 0.05 * std::numbers::sqrt2;
  const SignedDistance<double> d =
      distance_between(placed(plank, {0, 2 * height + 0.01, 0}, across), placed(plank, V::Zero(), edge));
  EXPECT_NEAR(d.distance, 0.01, 1e-9);
  EXPECT_NEAR(d.normal.y(), 1, 1e-9);
}

// No point of a is nearer to b than two boxes are said to be apart.
TEST(Touching, DistancesOfBoxesAreNeverMoreThanTheyAre) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return V(number(random), number(random), number(random)); };
  int apart = 0;
  for (int n = 0; n < 200; ++n) {
    const auto turned = [&] {
      return Quat<double>(Eigen::Vector4d(vector().x(), vector().y(), vector().z(), 0.3)).normalized();
    };
    const PlacedCollider<double> a = placed(kBox, 0.5 * vector(), turned()),
                                 b = placed(kBox, V::Zero(), turned());
    const double said = distance_between(a, b).distance;
    if (said <= 0) continue;
    ++apart;
    for (int k = 0; k < 1000; ++k) {
      const V on_a = a.pose * V(vector().cwiseProduct(kBox.size));
      ASSERT_GE(signed_distance<double>(Shape::kBox, kBox.size, b.pose.inverse() * on_a).distance,
                said - 1e-9);
    }
  }
  EXPECT_GT(apart, 20);
}

}  // namespace
}  // namespace sinew
