// Impacts: restitution, fast bodies and thin walls, loads on light bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "character/scenes.h"
#include "sinew/character/world.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"

namespace sinew {
namespace {

using V = Vec3<double>;

template <class T>
struct Props {
  World<T> world;

  explicit Props(const WorldSettings& settings = {}) : world(settings) {
    EXPECT_TRUE(world.template declare<Restitution>().ok());
    EXPECT_TRUE(world.template declare<ContinuousDetection>().ok());
  }
  int add(const PropSettings& prop) {
    Status status;
    const int index = world.add_prop(prop, status);
    EXPECT_GE(index, 0) << status.reason;
    return index;
  }
  double height(int prop) const { return double(world.prop_pose(prop).translation.z()); }
  double energy() const {
    double sum = 0;
    for (int n = 0; n < world.prop_count(); ++n) {
      const CharacterReport& r = world.prop_report(n);
      sum += r.kinetic_energy + r.potential_energy + r.elastic_energy;
    }
    return sum;
  }
};

PropSettings ball(double radius, double mass, const V& position, const V& velocity = V::Zero()) {
  PropSettings p;
  p.size = V::Constant(radius);
  p.mass = mass;
  p.pose.translation = position;
  p.velocity = velocity;
  return p;
}

WorldSettings weightless() {
  WorldSettings settings;
  settings.gravity = V::Zero();
  settings.ground = false;
  return settings;
}

template <class T>
class Impact : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Impact, Scalars);

// The figure: 0.25 ± 0.02 of the height with e = 0.5, and no step that gains energy. The tolerance of
// a step's energy is what float positions resolve: 1 kg · g · 1e-6 m.
TYPED_TEST(Impact, BallReturnsToEsSquareOfItsHeight) {
  using T = TypeParam;
  for (const double h : {1.0 / 240, 1.0 / 120, 1.0 / 60, 1.0 / 30}) {
    Props<T> scene;
    PropSettings settings = ball(0.1, 1, {0, 0, 1.1});
    settings.restitution = 0.5;
    scene.add(settings);
    ASSERT_TRUE(scene.world.step(T(h)).ok());
    double highest = 0, last = scene.energy();
    bool fell = false;
    for (double t = h; t < 1.2; t += h) {
      ASSERT_TRUE(scene.world.step(T(h)).ok());
      fell = fell || scene.height(0) < 0.15;
      if (fell) highest = std::max(highest, scene.height(0) - 0.1);
      EXPECT_LE(scene.energy(), last + 1e-4) << "h " << h << " at " << t;
      last = scene.energy();
    }
    EXPECT_NEAR(highest, 0.25, 0.02) << "h " << h;
  }
}

TYPED_TEST(Impact, BallWithoutRestitutionStays) {
  using T = TypeParam;
  Props<T> scene;
  scene.add(ball(0.1, 1, {0, 0, 1.1}));
  double highest = 0;
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
    if (n > 40) highest = std::max(highest, scene.height(0) - 0.1);
  }
  EXPECT_LT(highest, 0.01);
}

TYPED_TEST(Impact, WorldThatDeclaresNothingNeitherBouncesNorLooksAhead) {
  using T = TypeParam;
  World<T> world({});
  Status status;
  PropSettings bouncy = ball(0.1, 1, {0, 0, 1.1});
  bouncy.restitution = 0.5;
  ASSERT_EQ(world.add_prop(bouncy, status), 0);
  Collider wall;
  wall.shape = Shape::kBox;
  wall.size = {0.005, 2, 2};
  wall.local.translation = {5, 0, 0};
  ASSERT_TRUE(world.add_obstacle(wall).ok());
  ASSERT_EQ(world.add_prop(ball(0.005, 1, {4, 0, 1}, {200, 0, 0}), status), 1);
  T highest = T(0);
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(world.step(T(1) / 60).ok());
    if (n > 40) highest = std::max(highest, world.prop_pose(0).translation.z());
  }
  EXPECT_LT(highest, T(0.11));
  EXPECT_GT(world.prop_pose(1).translation.x(), T(5));
}

TEST(ImpactMemory, DeclaredEffectsAreCountedOnceAndTheCapRefusesThem) {
  Status status;
  World<float> world({});
  world.add_prop(ball(0.1, 1, V::Zero()), status);
  const std::size_t without = world.memory().total();
  ASSERT_TRUE(world.declare<Restitution>().ok());
  const std::size_t with = world.memory().total();
  EXPECT_GT(with, without);
  ASSERT_TRUE(world.declare<Restitution>().ok());
  EXPECT_EQ(world.memory().total(), with);
  WorldSettings narrow;
  narrow.memory_cap = without + 64;
  World<float> capped(narrow);
  ASSERT_EQ(capped.add_prop(ball(0.1, 1, V::Zero()), status), 0);
  EXPECT_EQ(capped.declare<Restitution>().code, Code::kOutOfRange);
  EXPECT_EQ(capped.memory().total(), without);
}

TYPED_TEST(Impact, HeadOnBallsPartByHalfTheirSpeedAndKeepMomentum) {
  using T = TypeParam;
  Props<T> scene(weightless());
  PropSettings one = ball(0.1, 1, {-0.5, 0, 0}, {2, 0, 0}), two = ball(0.1, 3, {0.5, 0, 0}, {-1, 0, 0});
  one.restitution = two.restitution = 0.5;
  scene.add(one);
  scene.add(two);
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  const double v1 = double(scene.world.prop_velocity(0).x()), v2 = double(scene.world.prop_velocity(1).x());
  EXPECT_NEAR(v1 + 3 * v2, -1, 1e-4);
  EXPECT_NEAR(v2 - v1, 1.5, 0.02);
}

/// Along x, one diameter apart: those that touch hand the blow on, the last flies off.
TYPED_TEST(Impact, ARowOfBallsHandsABlowOn) {
  using T = TypeParam;
  for (const double h : {1.0 / 120, 1.0 / 60, 1.0 / 30}) {
    Props<T> scene(weightless());
    for (int n = 0; n < 5; ++n) {
      PropSettings settings = ball(0.05, 1, {n == 0 ? -0.5 : 0.1 * n, 0, 0}, {n == 0 ? 2.0 : 0, 0, 0});
      settings.restitution = 1;
      settings.friction = 0;
      scene.add(settings);
    }
    for (double t = 0; t < 0.6; t += h) ASSERT_TRUE(scene.world.step(T(h)).ok());
    const double first = double(scene.world.prop_pose(0).translation.x()),
                 last = double(scene.world.prop_pose(4).translation.x());
    EXPECT_NEAR(first, 0, 0.01) << h;
    EXPECT_NEAR(last, 0.4 + 2 * 0.6 - 0.5, 0.06) << h;
    EXPECT_NEAR(scene.energy(), 2, 0.01) << h;
  }
}

/// A rack of ten, struck off its middle: whatever strikes whom in a step, all momentum stays, and no energy
/// comes.
TYPED_TEST(Impact, ABilliardBreakKeepsItsMomentum) {
  using T = TypeParam;
  constexpr double kRadius = 0.0286, kApart = 2.02 * kRadius;
  for (const double h : {1.0 / 120, 1.0 / 60, 1.0 / 30}) {
    Props<T> scene(weightless());
    const auto add = [&](const V& place, const V& velocity) {
      PropSettings settings = ball(kRadius, 0.17, place, velocity);
      settings.restitution = 0.95;
      settings.friction = 0;
      scene.add(settings);
    };
    add({-0.3, 0.002, 0}, {6, 0, 0});
    for (int row = 0; row < 4; ++row)
      for (int n = 0; n <= row; ++n) add({row * kApart * 0.866, (n - row / 2.0) * kApart, 0}, V::Zero());
    double before = 0.17 * 18;
    for (double t = 0; t < 0.3; t += h) {
      std::vector<V> from;
      for (int n = 0; n < 11; ++n)
        from.push_back(scene.world.prop_pose(n).translation.template cast<double>());
      ASSERT_TRUE(scene.world.step(T(h)).ok());
      V sum = V::Zero();  // of what all move by: those that are struck within the step go on differently
      for (int n = 0; n < 11; ++n)
        sum +=
            0.17 * (scene.world.prop_pose(n).translation.template cast<double>() - from[std::size_t(n)]) / h;
      EXPECT_NEAR(sum.x(), 0.17 * 6, 0.02) << h << " at " << t;
      EXPECT_LT(std::abs(sum.y()), 0.02) << h << " at " << t;
      EXPECT_LE(scene.energy(), before * 1.001) << h << " at " << t;
      before = scene.energy();
    }
    EXPECT_GT(before, 0.7 * 0.17 * 18) << h;
  }
}

/// Whether it bounces, and whatever is tied to it or to what it meets.
TYPED_TEST(Impact, NothingPassesAThinPost) {
  using T = TypeParam;
  for (const double restitution : {0.0, 0.6})
    for (const bool tied : {false, true})
      for (const double h : {1.0 / 120, 1.0 / 60, 1.0 / 30}) {
        Props<T> scene(weightless());
        Collider post;
        post.shape = Shape::kCapsule;
        post.size = {0.04, 0.04, 1};
        ASSERT_TRUE(scene.world.add_obstacle(post).ok());
        for (int n = 0; n < 12; ++n) {
          PropSettings settings =
              ball(0.05, 0.4, {-1 - 0.037 * n, 0.005 * (n - 6), -0.9 + 0.15 * n}, {20, 0, 0});
          settings.restitution = restitution;
          const int index = scene.add(settings);
          if (!tied) continue;
          LoopSettings rope;
          rope.kind = LoopKind::kRope;
          rope.length = 50;
          rope.b.kind = AnchorKind::kProp;
          rope.b.index = index;
          Status status;
          scene.world.add_loop(rope, status);
          ASSERT_TRUE(status.ok()) << status.reason;
        }
        for (double t = 0; t < 0.3; t += h) ASSERT_TRUE(scene.world.step(T(h)).ok());
        for (int n = 0; n < 12; ++n)
          EXPECT_LT(double(scene.world.prop_pose(n).translation.x()), 0.5)
              << restitution << (tied ? ", on a rope, " : ", ") << h << ", ball " << n;
      }
}

TYPED_TEST(Impact, NothingPassesAThinWall) {
  using T = TypeParam;
  for (const double speed : {10.0, 40.0, 200.0, 900.0})
    for (const double radius : {0.005, 0.05})
      for (const double h : {1.0 / 120, 1.0 / 60, 1.0 / 30}) {
        Props<T> scene(weightless());
        Collider wall;
        wall.shape = Shape::kBox;
        wall.size = {0.005, 2, 2};
        ASSERT_TRUE(scene.world.add_obstacle(wall).ok());
        // Starts at a fraction of a step that differs from case to case.
        scene.add(ball(radius, 1, {-1 - 0.37 * speed * h, 0.1, 0.2}, {speed, 0, 0}));
        double furthest = -10;
        for (int n = 0; n < 200 && furthest < -0.5 * radius; ++n) {
          ASSERT_TRUE(scene.world.step(T(h)).ok());
          furthest = std::max(furthest, double(scene.world.prop_pose(0).translation.x()));
        }
        for (int n = 0; n < 20; ++n) {
          ASSERT_TRUE(scene.world.step(T(h)).ok());
          furthest = std::max(furthest, double(scene.world.prop_pose(0).translation.x()));
        }
        EXPECT_GT(furthest, -0.1 - radius) << "arrived";
        EXPECT_LT(furthest, 0.0) << "speed " << speed << " radius " << radius << " h " << h;
      }
}

TYPED_TEST(Impact, FastBallsDoNotPassEachOther) {
  using T = TypeParam;
  Props<T> scene(weightless());
  scene.add(ball(0.05, 1, {-3, 0, 0}, {40, 0, 0}));
  scene.add(ball(0.05, 1, {3, 0, 0}, {-40, 0, 0}));
  for (int n = 0; n < 30; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  EXPECT_LT(scene.world.prop_pose(0).translation.x(), scene.world.prop_pose(1).translation.x());
}

TYPED_TEST(Impact, LightCubeBearsAHundredTimesItsWeight) {
  using T = TypeParam;
  Props<T> scene;
  PropSettings cube;
  cube.shape = Shape::kBox;
  cube.size = V::Constant(0.1);
  cube.mass = 1;
  cube.pose.translation = {0, 0, 0.1};
  scene.add(cube);
  cube.size = V::Constant(0.15);
  cube.mass = 100;
  cube.pose.translation = {0.01, 0, 0.45};
  scene.add(cube);
  for (int n = 0; n < 180; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  EXPECT_GT(scene.height(0), 0.099);  // sink depth 0.5 mm, twice for two layers
  EXPECT_GT(scene.height(1), 0.348);
}

TYPED_TEST(Impact, ParkedPropNeitherMovesNorTouchesUntilItIsPlaced) {
  using T = TypeParam;
  Props<T> scene;
  scene.add(ball(0.1, 1, {0, 0, 0.1}));
  scene.add(ball(0.1, 5, {0.05, 0, 0.15}));  // inside the first
  (void)scene.world.park_prop(1);
  for (int n = 0; n < 30; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  EXPECT_NEAR(double(scene.world.prop_pose(0).translation.x()), 0, 1e-6);
  EXPECT_EQ(scene.world.prop_pose(1).translation.z(), T(0.15));
  Transform<T> above;
  above.translation = {T(0), T(0), T(1)};
  (void)scene.world.set_prop(1, above, Vec3<T>::Zero(), Vec3<T>::Zero());
  for (int n = 0; n < 6; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  EXPECT_LT(scene.height(1), 0.96);
}

TYPED_TEST(Impact, AlignedTowerStands) {
  using T = TypeParam;
  Props<T> scene;
  PropSettings cube;
  cube.shape = Shape::kBox;
  cube.size = V::Constant(0.1);
  for (int n = 0; n < 5; ++n) {
    cube.pose.translation = {0, 0, 0.1 + 0.2 * n};
    scene.add(cube);
  }
  for (int n = 0; n < 300; ++n) ASSERT_TRUE(scene.world.step(T(1) / 60).ok());
  EXPECT_NEAR(scene.height(4), 0.9, 0.01);
}

TEST(Impact, FiguresCaughtInEachOtherComeFreeAndFall) {
  World<float> world(WorldSettings{});
  const Skeleton skeleton = fixtures::humanoid();
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  Status status;
  for (int n = 0; n < 2; ++n) {
    ASSERT_EQ(world.add_character(skeleton, limp, status), n) << status.reason;
    std::vector<JointJet<float>> jets = fixtures::idle<float>(skeleton, 0);
    jets[0].translation += Vec3<float>(0.05f, 0.02f, 0) * float(n);
    ASSERT_TRUE(world.character(n).set_target(jets).ok());
    (void)world.character(n).reset();
  }
  const float height = world.character(0).model()[0].translation.z();
  int held = 0;
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(world.step(1 / 60.f).ok());
    held += world.character(0).report().frozen > 0;
  }
  const auto highest =
      std::max(world.character(0).model()[0].translation.z(), world.character(1).model()[0].translation.z());
  EXPECT_LE(held, 6);
  EXPECT_LT(highest, height - 0.3f);
}

}  // namespace
}  // namespace sinew
