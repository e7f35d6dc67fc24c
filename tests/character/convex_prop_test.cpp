// Convex solids that move and that stand: what they lie on, what they carry, and what runs into them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "character/scenes.h"
#include "sinew/character/queries.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/hull_distance.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

using V = Vec3<double>;

ConvexHull hull_of(const std::vector<V>& points) {
  ConvexHull hull;
  const Status status = ConvexHull::make(points, hull);
  EXPECT_TRUE(status.ok()) << status.reason;
  return hull;
}

ConvexHull cuboid(const V& half) {
  std::vector<V> points;
  for (int n = 0; n < 8; ++n)
    points.emplace_back(half.cwiseProduct(V(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1)));
  return hull_of(points);
}

ConvexHull barrel(int sides, double radius, double half, double top) {
  std::vector<V> points;
  for (int n = 0; n < sides; ++n) {
    const V out(std::cos(2 * M_PI * n / sides), std::sin(2 * M_PI * n / sides), 0);
    points.emplace_back(radius * out - V(0, 0, half));
    points.emplace_back(top * out + V(0, 0, half));
  }
  return hull_of(points);
}

ConvexHull rock(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<V> points;
  for (int n = 0; n < 14; ++n)
    points.emplace_back(
        size * V(normal(random), normal(random), normal(random)).normalized().cwiseProduct(V(1, 0.8, 0.6)));
  return hull_of(points);
}

/// Rises from x = −`half` to x = `half` by that slope, 2 m wide; the middle of its slope is the origin.
ConvexHull ramp(double half, double slope) {
  const double height = half * slope;
  std::vector<V> points;
  for (const double y : {-1.0, 1.0}) {
    points.emplace_back(-half, y, -height);
    points.emplace_back(half, y, -height);
    points.emplace_back(half, y, height);
  }
  return hull_of(points);
}

PropSettings prop_of(const ConvexHull& hull, const V& at, double mass = 10) {
  PropSettings prop;
  prop.hull = &hull;
  prop.pose.translation = at;
  prop.mass = mass;
  return prop;
}

Collider obstacle_of(const ConvexHull& hull, const V& at) {
  Collider obstacle = convex_collider(hull);
  obstacle.local.translation = at;
  return obstacle;
}

/// m, of a hull's lowest corner.
template <class T>
double lowest(const ConvexHull& hull, const Transform<T>& pose) {
  double least = INFINITY;
  for (const V& c : hull.corners()) least = std::min(least, double((pose * c.cast<T>()).z()));
  return least;
}

template <class T>
void run(World<T>& world, double seconds, double hz = 60) {
  for (int n = 0; n < std::lround(seconds * hz); ++n) ASSERT_TRUE(world.step(T(1 / hz)).ok());
}

template <class T>
class ConvexProps : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(ConvexProps, Scalars);

TYPED_TEST(ConvexProps, FallTumbleAndLieStill) {
  using T = TypeParam;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const ConvexHull hull = seed == 0   ? barrel(12, 0.3, 0.45, 0.3)
                            : seed == 1 ? barrel(6, 0.3, 0.3, 0)
                                        : rock(seed, 0.3);
    for (const double hz : {30.0, 60.0, 120.0}) {
      World<T> world({});
      Status status;
      PropSettings prop = prop_of(hull, {0, 0, 1.5});
      prop.velocity = {1, 0.5, 0};
      prop.angular_velocity = {2, -3, 1};
      ASSERT_EQ(world.add_prop(prop, status), 0) << status.reason;
      double deepest = 0;
      for (int n = 0; n < std::lround(8 * hz); ++n) {
        ASSERT_TRUE(world.step(T(1 / hz)).ok());
        deepest = std::min(deepest, lowest(hull, world.prop_pose(0)));
      }
      EXPECT_GT(deepest, -0.012) << seed << " at " << hz;
      EXPECT_NEAR(lowest(hull, world.prop_pose(0)), 0, 2e-3) << seed << " at " << hz;
      EXPECT_LT(world.prop_velocity(0).norm(), T(0.01)) << seed << " at " << hz;
    }
  }
}

TYPED_TEST(ConvexProps, GoAsTheBoxesThatTheyAre) {
  using T = TypeParam;
  const V half(0.3, 0.2, 0.1);
  const ConvexHull hull = cuboid(half);
  World<T> of_hull({}), of_box({});
  Status status;
  PropSettings prop = prop_of(hull, {0, 0, 0.1});
  prop.velocity = {3, 0, 0};
  ASSERT_EQ(of_hull.add_prop(prop, status), 0);
  prop.hull = nullptr;
  prop.shape = Shape::kBox;
  prop.size = half;
  ASSERT_EQ(of_box.add_prop(prop, status), 0);
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(of_hull.step(T(1) / 60).ok());
    ASSERT_TRUE(of_box.step(T(1) / 60).ok());
    ASSERT_LT((of_hull.prop_pose(0).translation - of_box.prop_pose(0).translation).norm(), T(2e-3)) << n;
  }
  EXPECT_NEAR(of_hull.prop_pose(0).translation.x(), T(9 / (2 * 0.6 * 9.81)), T(0.03)) << "slides v²/2μg";
}

TYPED_TEST(ConvexProps, TheCentreOfMassDecidesHowAWedgeFalls) {
  using T = TypeParam;
  // A wedge that overhangs a table by so much that its middle of mass is over it, or beyond.
  const ConvexHull wedge =
      hull_of({{0, -0.2, 0}, {0.9, -0.2, 0}, {0, -0.2, 0.3}, {0, 0.2, 0}, {0.9, 0.2, 0}, {0, 0.2, 0.3}});
  ASSERT_NEAR(wedge.center_of_mass().x(), 0.3, 1e-9);
  for (const double over : {0.5, 0.7}) {  // of 0.9 m of its length
    World<T> world({});
    Collider table;
    table.shape = Shape::kBox;
    table.size = {0.5, 0.5, 0.5};
    table.local.translation = {-0.5, 0, 0.5};
    ASSERT_TRUE(world.add_obstacle(table).ok());
    Status status;
    ASSERT_EQ(world.add_prop(prop_of(wedge, {over - 0.9, 0, 1}), status), 0) << status.reason;
    run(world, 2);
    if (over < 0.6)
      EXPECT_NEAR(world.prop_pose(0).translation.z(), T(1), T(2e-3));
    else
      EXPECT_LT(world.prop_pose(0).translation.z(), T(0.9));
  }
}

TYPED_TEST(ConvexProps, StandOnEachOtherAndOnRamps) {
  using T = TypeParam;
  const ConvexHull cask = barrel(10, 0.3, 0.4, 0.25), slope = ramp(1.5, 0.3),
                   stone = cuboid({0.3, 0.25, 0.2});
  World<T> world({});
  Status status;
  PropSettings prop = prop_of(cask, {3, 0, 0.4}, 40);
  for (int n = 0; n < 3; ++n) {
    prop.pose.translation.z() = 0.4 + 0.8 * n;
    ASSERT_EQ(world.add_prop(prop, status), n);
  }
  ASSERT_TRUE(world.add_obstacle(obstacle_of(slope, {0, 0, 0.45})).ok());
  const double angle = std::atan(0.3);
  PropSettings block = prop_of(stone, V(0, 0, 0.45) + 0.2 * V(-std::sin(angle), 0, std::cos(angle)));
  block.pose.rotation = Eigen::AngleAxisd(-angle, V::UnitY());
  ASSERT_EQ(world.add_prop(block, status), 3);
  run(world, 5);
  for (int n = 0; n < 3; ++n) {
    const V moved = world.prop_pose(n).translation.template cast<double>() - V(3, 0, 0.4 + 0.8 * n);
    EXPECT_LT(moved.norm(), 5e-3) << "the " << n << "th of the stack";
  }
  EXPECT_LT((world.prop_pose(3).translation.template cast<double>() - block.pose.translation).norm(), 5e-3)
      << "friction of 0.6 holds on a slope of 0.3";
}

TYPED_TEST(ConvexProps, BallsRollDownRampsAtFiveSeventhsOfTheSlope) {
  using T = TypeParam;
  const ConvexHull slope = ramp(3, 0.2);
  World<T> world({});
  ASSERT_TRUE(world.add_obstacle(obstacle_of(slope, {0, 0, 0.6})).ok());
  const double angle = std::atan(0.2);
  const V up(-std::sin(angle), 0, std::cos(angle)), from = V(2, 0, 1) + 0.1 * up;
  PropSettings ball;
  ball.pose.translation = from;
  Status status;
  ASSERT_EQ(world.add_prop(ball, status), 0);
  run(world, 1);
  const V way = world.prop_pose(0).translation.template cast<double>() - from;
  EXPECT_NEAR(way.norm(), 0.5 * 5 / 7 * 9.81 * std::sin(angle), 0.02);
  EXPECT_NEAR(way.dot(up), 0, 2e-3);
}

TYPED_TEST(ConvexProps, ThrownAtWallsAndAtEachOtherDoNotGoThrough) {
  using T = TypeParam;
  const ConvexHull stone = rock(4, 0.15), plate = cuboid({0.05, 1, 1});
  for (const double speed : {5.0, 15.0, 40.0})
    for (const bool moves : {false, true}) {
      World<T> world({});
      ASSERT_TRUE(world.template declare<ContinuousDetection>().ok());
      Status status;
      PropSettings thrown = prop_of(stone, {-1.5, 0.1, 1.2}, 2);
      thrown.velocity = {speed, 0, 0};
      thrown.angular_velocity = {3, 8, -5};
      ASSERT_EQ(world.add_prop(thrown, status), 0);
      if (moves)
        ASSERT_EQ(world.add_prop(prop_of(plate, {0, 0, 1}, 400), status), 1);
      else
        ASSERT_TRUE(world.add_obstacle(obstacle_of(plate, {0, 0, 1})).ok());
      for (int n = 0; n < 60; ++n) {
        ASSERT_TRUE(world.step(T(1) / 60).ok());
        Transform<double> wall;
        wall.translation = {0, 0, 1};
        if (moves) wall = world.prop_pose(1).template cast<double>();
        const V at = wall.inverse() * world.prop_pose(0).translation.template cast<double>();
        ASSERT_LT(at.x(), 0.05) << speed << " m/s, frame " << n << (moves ? ", at what moves" : "");
      }
    }
}

TYPED_TEST(ConvexProps, AFigureFallsOverThemAndLiesStill) {
  using T = TypeParam;
  const ConvexHull stone = rock(2, 0.35), log = barrel(6, 0.2, 0.9, 0.2);
  for (const bool moves : {false, true}) {
    fixtures::Limp<T> limp({}, 0.9, 0.5, 3);
    Status status;
    Transform<double> lying;
    lying.rotation = Eigen::AngleAxisd(M_PI / 2, V::UnitX());
    lying.translation = {0.3, 0, 0.2};
    if (moves) {
      PropSettings prop = prop_of(log, lying.translation, 60);
      prop.pose = lying;
      ASSERT_GE(limp.world.add_prop(prop, status), 0);
      ASSERT_GE(limp.world.add_prop(prop_of(stone, {-0.5, 0, 0.3}, 80), status), 0);
    } else {
      Collider obstacle = convex_collider(log);
      obstacle.local = lying;
      ASSERT_TRUE(limp.world.add_obstacle(obstacle).ok());
      ASSERT_TRUE(limp.world.add_obstacle(obstacle_of(stone, {-0.5, 0, 0.1})).ok());
    }
    run(limp.world, 6);
    const Character<T> figure = limp.world.character(0);
    EXPECT_LT(figure.report().kinetic_energy, 0.5) << (moves ? "props" : "obstacles");
    EXPECT_LT(figure.report().penetration, 0.01);
    if (moves) continue;
    // By its joints: none in what it lies on.
    for (const Transform<T>& joint : figure.model()) {
      const V at = joint.translation.template cast<double>();
      EXPECT_GT(hull_distance(log, lying.inverse() * at).distance, 0.02);
      EXPECT_GT(hull_distance(stone, at - V(-0.5, 0, 0.1)).distance, 0.02);
    }
  }
}

TYPED_TEST(ConvexProps, AreStruckByRaysAndSavedAndRestored) {
  using T = TypeParam;
  const ConvexHull stone = rock(6, 0.4);
  World<T> world({});
  Status status;
  ASSERT_EQ(world.add_prop(prop_of(stone, {0, 0, 2}), status), 0);
  Cast ray;
  ray.from = {-3, 0.05, 2.02};
  ray.motion = {6, 0, 0};
  QueryHit hit[1];
  int count = 0;
  ASSERT_TRUE(cast(world, ray, hit, count).ok());
  ASSERT_EQ(count, 1);
  EXPECT_NEAR(hull_distance(stone, hit[0].position - V(0, 0, 2)).distance, 0, 1e-6);
  run(world, 0.4);
  std::vector<std::byte> bytes(1 << 16);
  bytes.resize(world.save(bytes));
  ASSERT_GT(bytes.size(), 0u);
  run(world, 1);
  const Transform<T> first = world.prop_pose(0);
  ASSERT_TRUE(world.restore(bytes).ok());
  run(world, 1);
  EXPECT_EQ(world.prop_pose(0).translation, first.translation);
  EXPECT_EQ(world.prop_pose(0).rotation.coeffs(), first.rotation.coeffs());
}

TEST(ConvexProp, WithoutAHullIsRefused) {
  World<float> world({});
  Status status;
  PropSettings prop;
  prop.shape = Shape::kConvex;
  EXPECT_EQ(world.add_prop(prop, status), -1);
  EXPECT_EQ(std::string(status.reason), "convex prop has no hull");
  const ConvexHull empty;
  prop.hull = &empty;
  EXPECT_EQ(world.add_prop(prop, status), -1);
  Collider obstacle;
  obstacle.shape = Shape::kConvex;
  EXPECT_EQ(world.add_obstacle(obstacle).code, Code::kInvalidArgument);
}

}  // namespace
}  // namespace sinew
