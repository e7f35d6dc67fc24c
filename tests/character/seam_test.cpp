// Surfaces that several shapes make up together: who comes along them meets no edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sinew/character/world.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

using V = Vec3<double>;

constexpr double kTile = 1, kTop = 1;  ///< m: their length along x, the height of their upper faces

/// m/s that is lost of the speed along x, and m that it rises at most over where it begins.
struct Passage {
  double slower = 0, hop = 0;
};

Collider tile(double from, double height) {
  Collider c;
  c.shape = Shape::kBox;
  c.size = {kTile / 2, 3, 0.1};
  c.local.translation = {from + kTile / 2, 0, height - 0.1};
  c.friction = 0.3;
  return c;
}

/// Of eight props alike, `apart` apart in where they begin, that move at v along x.
Passage pass(const PropSettings& prop, double v, double duration, double apart, double h,
             bool loose_tiles = false) {
  WorldSettings settings;
  settings.ground = loose_tiles;
  World<float> world(settings);
  EXPECT_TRUE(world.declare<ContinuousDetection>().ok());
  Status status;
  for (int n = -1; n < 14; ++n) {
    Collider t = tile(n * kTile, loose_tiles ? 0.2 : kTop);
    if (!loose_tiles) {
      EXPECT_TRUE(world.add_obstacle(t).ok());
      continue;
    }
    PropSettings plank;
    plank.shape = Shape::kBox;
    plank.size = t.size;
    plank.pose = t.local;
    plank.mass = 200;
    (void)world.add_prop(plank, status);
    EXPECT_TRUE(status.ok()) << status.reason;
  }
  constexpr int kProps = 8;
  std::vector<int> props;
  for (int n = 0; n < kProps; ++n) {
    PropSettings p = prop;
    p.pose.translation += V(0.1 + apart * n, -2.4 + 0.7 * n, loose_tiles ? 0.2 : kTop);
    p.velocity.x() = v;
    props.push_back(world.add_prop(p, status));
    EXPECT_TRUE(status.ok()) << status.reason;
  }
  Passage out;
  std::vector<double> first(kProps), last(kProps), speed(kProps);
  for (int n = 0; n < kProps; ++n) first[n] = last[n] = double(world.prop_pose(props[n]).translation.x());
  const double z = prop.pose.translation.z() + (loose_tiles ? 0.2 : kTop);
  for (int step = 0; step < static_cast<int>(std::lround(duration / h)); ++step) {
    EXPECT_TRUE(world.step(float(h)).ok());
    for (int n = 0; n < kProps; ++n) {
      const Vec3<float> at = world.prop_pose(props[n]).translation;
      speed[n] = (double(at.x()) - last[n]) / h;
      last[n] = double(at.x());
      out.hop = std::max(out.hop, double(at.z()) - z);
    }
  }
  for (int n = 0; n < kProps; ++n) out.slower = std::max(out.slower, v - speed[n]);
  return out;
}

PropSettings ball(double v) {
  PropSettings p;
  p.shape = Shape::kSphere;
  p.size = V::Constant(0.1);
  p.pose.translation.z() = 0.1;
  p.mass = 1;
  p.friction = 0.3;
  p.angular_velocity.y() = v / 0.1;
  return p;
}

PropSettings log_across(double v) {
  PropSettings p = ball(v);
  p.shape = Shape::kCapsule;
  p.size = {0.1, 0.1, 0.15};
  p.pose.rotation = Quat<double>(Eigen::AngleAxisd(M_PI / 2, V::UnitX()));
  return p;
}

TEST(Seams, BallsAndLogsRollOverThem) {
  for (const double h : {1 / 15.0, 1 / 30.0, 1 / 60.0, 1 / 120.0, 1 / 240.0})
    for (const PropSettings& prop : {ball(6), log_across(6)}) {
      const Passage is = pass(prop, 6, 1.6, 0.071, h);
      EXPECT_LT(is.slower, 0.03) << h << ' ' << static_cast<int>(prop.shape);
      EXPECT_LT(is.hop, 1e-3) << h << ' ' << static_cast<int>(prop.shape);
    }
}

TEST(Seams, PucksSlideOverThem) {
  ConvexHull hexagon;
  std::vector<V> corners;
  for (int n = 0; n < 6; ++n)
    for (const double z : {-0.01, 0.01})
      corners.emplace_back(0.15 * std::cos(n * M_PI / 3), 0.15 * std::sin(n * M_PI / 3), z);
  ASSERT_TRUE(ConvexHull::make(corners, hexagon).ok());
  PropSettings puck;
  puck.hull = &hexagon;
  puck.pose.translation.z() = 0.01;
  puck.mass = 1;
  puck.friction = 0;
  PropSettings box = puck;
  box.hull = nullptr;
  box.shape = Shape::kBox;
  box.size = {0.1, 0.1, 0.01};
  for (const double h : {1 / 15.0, 1 / 30.0, 1 / 60.0, 1 / 120.0, 1 / 240.0})
    for (const PropSettings& prop : {puck, box}) {
      const Passage is = pass(prop, 6, 1.6, 0.0625, h);
      EXPECT_LT(is.slower, 0.03) << h << (prop.hull ? " puck" : " box");
      EXPECT_LT(is.hop, 1e-3) << h << (prop.hull ? " puck" : " box");
    }
}

TEST(Seams, OfLooseBoardsAreNoneEither) {
  for (const double h : {1 / 30.0, 1 / 60.0, 1 / 120.0, 1 / 240.0}) {
    const Passage is = pass(ball(3), 3, 2.4, 0.071, h, true);
    EXPECT_LT(is.slower, 0.09) << h;  // 3 %: boards give under a ball
    EXPECT_LT(is.hop, 2e-3) << h;
  }
}

/// A kerb of 2 cm is no seam, nor is a wall that stands on the floor.
TEST(Seams, KerbsAndWallsAreNone) {
  for (const double h : {1 / 30.0, 1 / 60.0, 1 / 120.0}) {
    for (const double rises : {0.02, 0.5}) {
      World<float> world({});
      EXPECT_TRUE(world.declare<ContinuousDetection>().ok());
      Collider kerb = tile(1, rises);
      kerb.size.z() = rises / 2;
      kerb.local.translation.z() = rises / 2;
      ASSERT_TRUE(world.add_obstacle(kerb).ok());
      Collider floor = tile(0, 0);
      ASSERT_TRUE(world.add_obstacle(floor).ok());
      Status status;
      PropSettings box;
      box.shape = Shape::kBox;
      box.size = V::Constant(0.1);
      box.pose.translation = {0.5, 0, 0.1};
      box.velocity.x() = 1.5;
      box.friction = 0;
      (void)world.add_prop(box, status);
      ASSERT_TRUE(status.ok()) << status.reason;
      for (int n = 0; n < 1 / h; ++n) ASSERT_TRUE(world.step(float(h)).ok());
      const Vec3<float> at = world.prop_pose(0).translation;
      EXPECT_LT(at.x(), 0.901f) << h << ' ' << rises;
      EXPECT_GT(at.x(), 0.3f) << h << ' ' << rises;
    }
  }
}

}  // namespace
}  // namespace sinew
