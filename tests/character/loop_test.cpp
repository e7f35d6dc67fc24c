// Loops: what they hold, what they conserve, and that both sides feel them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "fixtures/counting_new.h"
#include "fixtures/paths.h"
#include "sinew/character/world.h"
#include "sinew/skeleton/rotation.h"
#include "study/linkage.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using study::Linkage;

constexpr double kH = 1.0 / 60;

WorldSettings airborne(const V& gravity = {0, 0, -9.81}) {
  WorldSettings settings;
  settings.ground = false;
  settings.gravity = gravity;
  return settings;
}

CharacterSettings passive() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

/// One rod; a hinge turns about y.
Linkage rod(JointType type, const V& from, const V& to, double mass) {
  Linkage l;
  l.add_rod(-1, type, from, to, V::UnitY(), mass);
  return l;
}

Anchor prop_anchor(int index, const V& at = V::Zero()) {
  Anchor anchor;
  anchor.kind = AnchorKind::kProp;
  anchor.index = index;
  anchor.frame.translation = at;
  return anchor;
}

Anchor world_anchor(const V& at) {
  Anchor anchor;
  anchor.frame.translation = at;
  return anchor;
}

template <class T>
struct Scene {
  World<T> world;

  explicit Scene(const WorldSettings& settings = airborne()) : world(settings) {}
  int add(const Linkage& l) {
    Status status;
    const int index = world.add_character(l.skeleton, passive(), status);
    EXPECT_GE(index, 0) << status.reason;
    (void)world.character(index).reset();
    return index;
  }
  int add_ball(const V& at, const V& velocity = V::Zero(), double mass = 1) {
    PropSettings prop;
    prop.mass = mass;
    prop.pose.translation = at;
    prop.velocity = velocity;
    Status status;
    const int index = world.add_prop(prop, status);
    EXPECT_GE(index, 0) << status.reason;
    return index;
  }
  int tie(LoopKind kind, const Anchor& a, const Anchor& b, double length = 0, double stiffness = 0) {
    LoopSettings loop;
    loop.stiffness = stiffness;
    loop.kind = kind;
    loop.a = a;
    loop.b = b;
    loop.length = length;
    Status status;
    const int index = world.add_loop(loop, status);
    EXPECT_GE(index, 0) << status.reason;
    return index;
  }
  void run(int steps, double h = kH) {
    for (int n = 0; n < steps; ++n) ASSERT_TRUE(world.step(T(h)).ok());
  }
  double energy() {
    double sum = 0;
    const auto add = [&](const CharacterReport& r) {
      sum += r.kinetic_energy + r.potential_energy + r.elastic_energy;
    };
    for (int c = 0; c < world.character_count(); ++c) add(world.character(c).report());
    for (int p = 0; p < world.prop_count(); ++p) add(world.prop_report(p));
    return sum;
  }
  std::vector<std::byte> snapshot() {
    std::vector<std::byte> bytes(world.snapshot_capacity());
    bytes.resize(world.save(bytes));
    return bytes;
  }
};

TEST(Loop, PendulumOnALoopSwingsAsOneOnAJoint) {
  for (const LoopKind kind : {LoopKind::kPoint, LoopKind::kHinge}) {
    WorldSettings settings = airborne();
    Scene<double> hinged(settings), tied(settings);
    hinged.add(rod(JointType::kRevolute, {0, 0, 0}, {1, 0, 0}, 2));
    const Linkage free = rod(JointType::kFree, {0, 0, 0}, {1, 0, 0}, 2);
    tied.add(free);
    Anchor a = free.anchor(0, {0, 0, 0}), b;
    a.frame.rotation = b.frame.rotation = rotation_between<double>(V::UnitZ(), V::UnitY());
    tied.tie(kind, a, b);
    double apart = 0, gap = 0;
    for (int n = 0; n < 60; ++n) {
      hinged.run(1);
      tied.run(1);
      gap = std::max(gap, tied.world.loop_gap(0));
      apart = std::max(apart, (hinged.world.character(0).model()[0] * V(1, 0, 0) -
                               tied.world.character(0).model()[0] * V(1, 0, 0))
                                  .norm());
    }
    // The loop gives by 0.1 mm under the rod's weight, and the swing's pull is three weights.
    EXPECT_LT(gap, 4e-4);
    EXPECT_LT(apart, 5e-3);
  }
}

/// Column of a reference table by its name, sampled every 0.1 s.
std::vector<double> reference(const std::string& file, const std::string& column) {
  std::ifstream in(shared_dir() + "/mechanisms/reference/" + file);
  std::string line, cell;
  std::getline(in, line);
  std::istringstream head(line);
  int wanted = -1;
  for (int c = 0; std::getline(head, cell, ','); ++c)
    if (cell == column) wanted = c;
  std::vector<double> values;
  while (wanted >= 0 && std::getline(in, line)) {
    std::istringstream row(line);
    for (int c = 0; std::getline(row, cell, ','); ++c)
      if (c == wanted) values.push_back(std::stod(cell));
  }
  return values;
}

TEST(Loop, BricardsMechanismFollowsItsReference) {
  const std::vector<double> x = reference("bricard.csv", "x:P3"), y = reference("bricard.csv", "y:P3"),
                            z = reference("bricard.csv", "z:P3");
  if (x.empty()) GTEST_SKIP() << "no reference trajectories beside the project";
  // 1 kg bars of 1 m and 0.1 m square section; the sixth hinge is the loop (IFToMM benchmark A04).
  Linkage l;
  const V ends[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const V axes[] = {V::UnitY(), V::UnitZ(), V::UnitX(), V::UnitY(), V::UnitZ()};
  for (int n = 0; n < 5; ++n) {
    const V along = ends[n + 1] - ends[n];
    const V square = (V::Constant(0.1) + 0.9 * along.cwiseAbs()).cwiseAbs2() / 12;
    const V inertia(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
    l.add(n - 1, JointType::kRevolute, ends[n], axes[n], 1, ends[n] + along / 2, inertia.asDiagonal());
  }
  Scene<double> scene(airborne({0, -9.81, 0}));
  scene.add(l);
  Anchor a = l.anchor(4, {0, 0, 1}), b = world_anchor({0, 0, 1});
  a.frame.rotation = b.frame.rotation = rotation_between<double>(V::UnitZ(), V::UnitX());
  scene.tie(LoopKind::kHinge, a, b);
  double worst = 0, gap = 0;
  for (int n = 1; n <= 10; ++n) {
    for (int k = 0; k < 48; ++k) {
      scene.run(1, 1.0 / 480);
      gap = std::max(gap, scene.world.loop_gap(0));
    }
    const V p3 = scene.world.character(0).model()[1] * V(0, -1, 0);
    worst = std::max(worst, (p3 - V(x[n], y[n], z[n])).norm());
  }
  EXPECT_LT(worst, 0.01) << "the catalogue's 1 % of a bar at 1 s";
  EXPECT_LT(gap, 5e-4);
}

TEST(Loop, PairInFlightKeepsItsMomenta) {
  WorldSettings exact = airborne(V::Zero());
  exact.accuracy.tolerance = 1e-10;
  Scene<double> scene(exact);
  scene.add_ball({0, 0, 0}, {0, 2, 0}, 1);
  scene.add_ball({1, 0, 0}, {0, -1, 0.5}, 3);
  scene.tie(LoopKind::kDistance, prop_anchor(0), prop_anchor(1), 1);
  const auto momenta = [&](V& linear, V& angular) {
    linear = angular = V::Zero();
    for (int p = 0; p < 2; ++p) {
      const CharacterReport& r = scene.world.prop_report(p);
      linear += r.momentum;
      angular += scene.world.prop_pose(p).translation.cross(r.momentum) + r.angular_momentum;
    }
  };
  scene.run(20);
  V before, spin_before, after, spin_after;
  momenta(before, spin_before);
  EXPECT_NEAR(before.y(), -1, 1e-6);  // 1·2 − 3·1 kg m/s
  scene.run(60);
  momenta(after, spin_after);
  EXPECT_LT((after - before).norm(), 1e-6) << "as exactly as the solve converges";
  // Centres go by chords: angular momentum is kept to the second order of h·ω = 0.05.
  EXPECT_LT((spin_after - spin_before).norm(), 0.01 * spin_before.norm());
}

TEST(Loop, EnergyNeverRisesWhileALimpChainHangsByBothEnds) {
  Linkage l;
  int above = -1;
  for (int n = 0; n < 8; ++n)
    above = l.add_rod(above, JointType::kBall, {0.15 * n, 0, 0.2 * (n % 2)},
                      {0.15 * (n + 1), 0, 0.2 * ((n + 1) % 2)}, V::UnitY(), 0.5);
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    Scene<float> scene;
    scene.add(l);
    scene.tie(LoopKind::kPoint, l.anchor(above, {1.2, 0, 0}), world_anchor({1.2, 0, 0}));
    double most = 0, start = 0, kinetic = 0;
    for (int n = 0; n < 3 / h; ++n) {
      scene.run(1, h);
      const CharacterReport& r = scene.world.character(0).report();
      if (n == 0) start = scene.energy();
      most = std::max(most, scene.energy() - start);
      kinetic = std::max(kinetic, r.kinetic_energy);
      EXPECT_TRUE(r.converged) << n;
    }
    EXPECT_LT(most, 1e-3 * kinetic) << "the catalogue's general condition";
    EXPECT_GT(kinetic, 1);
  }
}

TEST(Loop, WhatHangsOnALoopPullsByItsWeight) {
  // Both ways: the ball hangs on the hinged rod, whose weight it adds to.
  const Linkage l = rod(JointType::kRevolute, {0, 0, 0}, {0, 0, -1}, 2);
  Scene<double> scene;
  scene.add(l);
  scene.add_ball({0, 0, -1.5}, V::Zero(), 3);
  scene.tie(LoopKind::kRope, l.anchor(0, {0, 0, -1}), prop_anchor(0), 0.5);
  scene.run(240);
  const V force = scene.world.loop_force(0);
  EXPECT_NEAR(force.z(), -3 * 9.81, 0.01 * 3 * 9.81) << "settled to a hundredth";
  EXPECT_LT(scene.world.loop_gap(0), 2e-4);
}

/// Forces that hold a body's axis answer to where it has turned by the end of a step: carried on alone, they
/// amplify what makes it wobble once it turns by more than a twelfth of a radian in one.
template <class T>
void expect_spins_on(double spin, double h) {
  Scene<T> scene(airborne(V::Zero()));
  PropSettings wheel;
  wheel.shape = Shape::kBox;
  wheel.size = {0.3, 0.3, 0.05};
  wheel.mass = 20;
  wheel.angular_velocity = {0.3, 0.2, spin};
  Status status;
  const int index = scene.world.add_prop(wheel, status);
  ASSERT_GE(index, 0) << status.reason;
  scene.tie(LoopKind::kHinge, world_anchor(V::Zero()), prop_anchor(index));
  for (int n = 0; n < 4 / h; ++n) {
    const Quat<T> before = scene.world.prop_pose(index).rotation;
    scene.run(1, h);
    const double turned = double(before.angularDistance(scene.world.prop_pose(index).rotation)) / h;
    ASSERT_NEAR(turned, spin, 0.01 * spin) << spin << " rad/s in steps of " << h << ", step " << n;
    ASSERT_LT(scene.world.loop_gap(0), 5e-4) << spin;
  }
}

TEST(Loop, WhatSpinsOnAHingeIsNotBraked) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 120})
    for (const double spin : {5.0, 10.0, 20.0, 40.0, 80.0}) {
      expect_spins_on<float>(spin, h);
      expect_spins_on<double>(spin, h);
    }
}

TEST(Loop, RopePullsAndNeverPushes) {
  Scene<double> scene;
  scene.add_ball({0, 0, 1});
  scene.tie(LoopKind::kRope, prop_anchor(0), world_anchor({0, 0, 0}), 1.5);
  scene.run(18);
  const double fallen = 1 - scene.world.prop_pose(0).translation.z();
  EXPECT_NEAR(fallen, 0.5 * 9.81 * 0.3 * 0.3, 0.03) << "slack: free fall";
  EXPECT_EQ(scene.world.loop_force(0).norm(), 0);
  double lowest = 0;
  for (int n = 0; n < 120; ++n) {
    scene.run(1);
    lowest = std::min(lowest, double(scene.world.prop_pose(0).translation.z()));
  }
  EXPECT_GT(lowest, -1.55) << "caught at the rope's length";
  EXPECT_LT(lowest, -1.45);
}

/// What is struck or pulled on a spring goes on by its energy alone, at any rate of steps.
TEST(Loop, ASpringStretchesAsFarAsItsEnergyTakesIt) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240}) {
    Scene<double> scene(airborne(V::Zero()));
    scene.add_ball({0, 0, 0}, V::Zero(), 1);
    scene.add_ball({1, 0, 0}, {0.5, 0, 0}, 1);
    scene.tie(LoopKind::kDistance, prop_anchor(0), prop_anchor(1), 1, 50);
    double most = 0, later = 0;
    for (int n = 0; n < 3 / h; ++n) {
      scene.run(1, h);
      const double length =
          double((scene.world.prop_pose(1).translation - scene.world.prop_pose(0).translation).norm());
      double& so_far = n * h < 1 ? most : later;
      so_far = std::max(so_far, length - 1);
    }
    const double stretch = 0.5 / std::sqrt(50 / 0.5);  // the speed by the frequency of the reduced mass
    EXPECT_NEAR(most, stretch, 0.05 * stretch) << h;
    EXPECT_NEAR(later, stretch, 0.1 * stretch) << h << ": and swings on";
  }
}

TEST(Loop, WhoFallsOnAnElasticRopeComesUpAgain) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    Scene<double> scene;
    scene.add_ball({0, 0, 0}, V::Zero(), 80);
    scene.tie(LoopKind::kRope, world_anchor({0, 0, 0}), prop_anchor(0), 10, 100);
    double lowest = 0, back = 0;
    for (int n = 0; n < 8 / h; ++n) {
      scene.run(1, h);
      const double z = double(scene.world.prop_pose(0).translation.z());
      back = z < lowest ? z : std::max(back, z);
      lowest = std::min(lowest, z);
    }
    // ½ k (s − 10 m)² = m g s
    const double sag = 80 * 9.81 / 100, wanted = 10 + sag + std::sqrt(sag * (sag + 20));
    EXPECT_NEAR(-lowest, wanted, 0.01 * wanted) << h;
    EXPECT_NEAR(back, 0, 0.03 * wanted) << h;
  }
}

/// A link and a ball that hangs on it: 1 and 1000 kg, at rest and swung out level.
TEST(Loop, LightLinksBearWhatHangsOnThem) {
  for (const double h : {1.0 / 15, 1.0 / 30, 1.0 / 60, 1.0 / 240})
    for (const bool level : {false, true}) {
      Scene<float> scene;
      const V down = level ? V(V::UnitX()) : V(-V::UnitZ());
      scene.add_ball(0.1 * down, V::Zero(), 1);
      scene.add_ball(0.5 * down, V::Zero(), 1000);
      scene.tie(LoopKind::kPoint, world_anchor(V::Zero()), prop_anchor(0, -0.1 * down));
      scene.tie(LoopKind::kPoint, prop_anchor(0, 0.1 * down), prop_anchor(1, -0.3 * down));
      double furthest = 0;
      for (int n = 0; n < 2 / h; ++n) {
        scene.run(1, h);
        furthest = std::max(furthest, double(scene.world.prop_pose(1).translation.norm()));
      }
      EXPECT_NEAR(furthest, 0.5, level ? 2e-3 : 1e-3) << h << (level ? " swings" : " hangs");
    }
}

TEST(Loop, WhatBeginsOpenClosesAtAWalkingPace) {
  Scene<double> scene(airborne(V::Zero()));
  scene.add_ball({0.3, 0, 0});
  scene.tie(LoopKind::kPoint, prop_anchor(0), world_anchor({0, 0, 0}));
  double fastest = 0;
  for (int n = 0; n < 90; ++n) {
    scene.run(1);
    fastest = std::max(fastest, double(scene.world.prop_velocity(0).norm()));
  }
  EXPECT_LT(fastest, 0.6) << "0.45 m/s, and what the scheme swings beyond where it starts at once";
  EXPECT_GT(fastest, 0.3) << "0.3 m at 0.45 m/s take 0.7 s";
  EXPECT_LT(scene.world.prop_pose(0).translation.norm(), 2e-4);
}

TEST(Loop, OpenedAndClosedAgain) {
  Scene<float> scene;
  scene.add_ball({0, 0, 0});
  const int loop = scene.tie(LoopKind::kPoint, prop_anchor(0), world_anchor({0, 0, 0}));
  scene.run(30);
  EXPECT_LT(scene.world.prop_pose(0).translation.norm(), 2e-4f);
  (void)scene.world.set_loop(loop, false);
  scene.run(30);
  EXPECT_NEAR(scene.world.prop_pose(0).translation.z(), -0.5 * 9.81 * 0.25, 0.1);
  (void)scene.world.set_loop(loop, true);
  scene.run(240);
  EXPECT_LT(scene.world.prop_pose(0).translation.norm(), 2e-3f) << "brought back, hanging still";
}

TEST(Loop, HandsOfOneTreeCloseAcrossItsBranches) {
  Linkage l;
  const int trunk = l.add_rod(-1, JointType::kFree, {0, 0, 0}, {0, 0, 0.5}, V::UnitY(), 5, 0.1);
  const int left = l.add_rod(trunk, JointType::kBall, {0, 0.2, 0.5}, {0.6, 0, 0.5}, V::UnitY(), 1, 0.04);
  const int right = l.add_rod(trunk, JointType::kBall, {0, -0.2, 0.5}, {0.6, 0, 0.5}, V::UnitY(), 1, 0.04);
  Scene<float> scene;
  scene.add(l);
  scene.tie(LoopKind::kPoint, l.anchor(left, {0.6, 0, 0.5}), l.anchor(right, {0.6, 0, 0.5}));
  ASSERT_TRUE(scene.world.character(0).apply_impulse(left, {0.3f, 0.1f, 0.5f}, {0, 3, 1}).ok());
  double gap = 0, spread = 0;
  for (int n = 0; n < 120; ++n) {
    scene.run(1);
    gap = std::max(gap, scene.world.loop_gap(0));
    const auto model = scene.world.character(0).model();
    spread = std::max(spread, double(model[left].rotation.angularDistance(model[right].rotation)));
    EXPECT_TRUE(scene.world.character(0).report().converged) << n;
  }
  EXPECT_LT(gap, 3e-4);
  EXPECT_GT(spread, 0.05) << "the arms do move";
}

TEST(Loop, RestoredSnapshotGoesOnToTheBitWhileALoopCloses) {
  const auto make = [](Scene<float>& scene) {
    const Linkage l = rod(JointType::kFree, {0, 0, 0}, {1, 0, 0}, 2);
    scene.add(l);
    scene.add_ball({1.4, 0, 0});
    scene.tie(LoopKind::kPoint, l.anchor(0, {1, 0, 0}), prop_anchor(0));
    scene.tie(LoopKind::kWeld, l.anchor(0, {0, 0, 0}), world_anchor({0, 0, 0}));
  };
  Scene<float> one, other;
  make(one);
  make(other);
  one.run(10);  // 0.4 m at 0.45 m/s: still open
  ASSERT_TRUE(other.world.restore(one.snapshot()).ok());
  one.run(60);
  other.run(60);
  EXPECT_EQ(one.snapshot(), other.snapshot());
}

TEST(Loop, StepsAllocateNothing) {
  Linkage l;
  int above = -1;
  for (int n = 0; n < 8; ++n)
    above = l.add_rod(above, JointType::kBall, {0.25 * n, 0, 0}, {0.25 * (n + 1), 0, 0}, V::UnitY(), 0.5);
  Scene<float> scene;
  scene.add(l);
  scene.add_ball({2, 0, -0.3});
  scene.tie(LoopKind::kRope, l.anchor(above, {2, 0, 0}), prop_anchor(0), 0.4);
  scene.tie(LoopKind::kWeld, l.anchor(4, {1, 0, 0}), world_anchor({1, 0, 0}));
  const long before = fixtures::allocations;
  for (int n = 0; n < 60; ++n) (void)scene.world.step(float(kH));
  EXPECT_EQ(fixtures::allocations - before, 0);
}

TEST(Loop, RefusesWhatCannotBeMeant) {
  Scene<float> scene;
  scene.add_ball({0, 0, 0});
  Status status;
  const auto refused = [&](const LoopSettings& loop) {
    return scene.world.add_loop(loop, status) == -1 && !status.ok() && *status.reason;
  };
  EXPECT_TRUE(refused({})) << "the world to the world";
  LoopSettings loop;
  loop.a = prop_anchor(1);
  EXPECT_TRUE(refused(loop)) << "no such prop";
  loop.a = prop_anchor(0);
  loop.kind = LoopKind::kDistance;
  EXPECT_TRUE(refused(loop)) << "a rod without length";
  loop.length = std::nan("");
  EXPECT_TRUE(refused(loop));
  loop.length = 1;
  loop.stiffness = -1;
  EXPECT_TRUE(refused(loop));
  loop.stiffness = 0;
  loop.b.frame.rotation.w() = 3;
  EXPECT_TRUE(refused(loop)) << "no rotation";
  loop.b.frame.rotation.w() = 1;
  EXPECT_EQ(scene.world.add_loop(loop, status), 0);
}

}  // namespace
}  // namespace sinew
