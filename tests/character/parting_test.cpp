// What begins inside something else, as levels are built and things are spawned: it parts at a walking pace.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sinew/character/world.h"
#include "sinew/effects/continuous_detection.h"

namespace sinew {
namespace {

using V = Vec3<double>;

constexpr double kRates[] = {15, 30, 60, 120, 240};  ///< Hz
constexpr double kHalf = 0.2;                        ///< m, of all that part here

PropSettings thing(Shape shape, const V& at) {
  PropSettings p;
  p.shape = shape;
  p.size = V::Constant(kHalf);
  p.pose.translation = at;
  p.mass = 5;
  return p;
}

/// How two things without weight part: when (s), how fast at most before (m/s), and after a second more (m).
struct Parting {
  double time = 0, fastest = 0, further = 0;
};

/// Of two that begin `deep` (m) in each other along x; 1 m is how far apart they are when they have.
Parting part(Shape a, Shape b, double deep, double hz) {
  WorldSettings settings;
  settings.ground = false;
  settings.gravity = V::Zero();
  World<float> world(settings);
  EXPECT_TRUE(world.declare<ContinuousDetection>().ok());
  Status status;
  (void)world.add_prop(thing(a, {0, 0.01, 0.02}), status);
  EXPECT_TRUE(status.ok()) << status.reason;
  (void)world.add_prop(thing(b, {2 * kHalf - deep, 0, 0}), status);
  EXPECT_TRUE(status.ok()) << status.reason;
  Parting out;
  const auto apart = [&] {
    return double((world.prop_pose(1).translation - world.prop_pose(0).translation).norm());
  };
  double before = apart();
  bool parted = false;
  for (int n = 1; n <= 3 * hz; ++n) {
    EXPECT_TRUE(world.step(float(1 / hz)).ok());
    const double is = apart();
    out.fastest = std::max(out.fastest, (is - before) * hz);
    before = is;
    if (!parted && is > 2 * kHalf - 0.01) {
      parted = true;
      out.time = n / hz;
    }
  }
  if (!parted) out.time = 1e9;
  out.further = before;
  return out;
}

TEST(Parting, ThingsThatBeginInEachOtherDoSoAtAWalkingPace) {
  for (const double hz : kRates)
    for (const auto& [a, b] : {std::pair{Shape::kBox, Shape::kBox},
                               {Shape::kSphere, Shape::kSphere},
                               {Shape::kBox, Shape::kSphere},
                               {Shape::kCapsule, Shape::kBox}})
      for (const double deep : {0.1, 0.2}) {
        const Parting is = part(a, b, deep, hz);
        EXPECT_LT(is.time, deep / 0.3 + 0.2) << hz << ' ' << int(a) << int(b) << ' ' << deep;
        EXPECT_LT(is.fastest, 0.9) << hz << ' ' << int(a) << int(b) << ' ' << deep;
      }
}

TEST(Parting, WhatBeginsInTheFloorComesUpAtAWalkingPace) {
  for (const double hz : kRates)
    for (const Shape shape : {Shape::kBox, Shape::kSphere}) {
      World<float> world({});
      EXPECT_TRUE(world.declare<ContinuousDetection>().ok());
      Status status;
      (void)world.add_prop(thing(shape, {0, 0, 0}), status);
      ASSERT_TRUE(status.ok()) << status.reason;
      double before = 0, fastest = 0, highest = 0, time = 1e9;
      for (int n = 1; n <= 2 * hz; ++n) {
        ASSERT_TRUE(world.step(float(1 / hz)).ok());
        const double z = double(world.prop_pose(0).translation.z());
        fastest = std::max(fastest, (z - before) * hz);
        highest = std::max(highest, z);
        before = z;
        if (time > 1e8 && z > kHalf - 0.01) time = n / hz;
      }
      EXPECT_LT(time, kHalf / 0.3 + 0.2) << hz << ' ' << int(shape);
      EXPECT_LT(fastest, 0.9) << hz << ' ' << int(shape);
      EXPECT_LT(highest, kHalf + 0.02) << hz << ' ' << int(shape);
    }
}

/// Each in all others, turned and shifted a little: they end beside and on each other. At 15 Hz three are
/// still in each other after ten seconds.
TEST(Parting, SixInEachOtherAllDo) {
  for (const double hz : {30.0, 60.0, 120.0, 240.0}) {
    World<float> world({});
    EXPECT_TRUE(world.declare<ContinuousDetection>().ok());
    Status status;
    for (int n = 0; n < 6; ++n) {
      PropSettings p = thing(Shape::kBox, {0.02 * n, 0.03 * n, 0.21 + 0.1 * n});
      p.mass = 1;
      p.pose.rotation = Eigen::AngleAxisd(0.1 * n, V::UnitX()) * Eigen::AngleAxisd(0.2 * n, V::UnitY());
      (void)world.add_prop(p, status);
      ASSERT_TRUE(status.ok()) << status.reason;
    }
    for (int n = 0; n < 10 * hz; ++n) ASSERT_TRUE(world.step(float(1 / hz)).ok());
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < a; ++b) {
        const Vec3<float> between = world.prop_pose(a).translation - world.prop_pose(b).translation;
        EXPECT_GT(between.norm(), 2 * kHalf - 0.01) << a << " and " << b << " at " << hz;
      }
  }
}

}  // namespace
}  // namespace sinew
