// What a world's debug view shows.
#include "sinew/character/debug_draw.h"

#include <algorithm>
#include <string>

#include "character/scenes.h"
#include "sinew/character/contact_events.h"

namespace sinew {
namespace {

using fixtures::Playing;
using namespace debug_colors;

constexpr DebugDrawSettings kNothing{false, false, false, false, false, false, false, false, 1e-3};

struct Line {
  Vec3<double> from, to;
  DebugColor color;
};
struct Triangle {
  std::array<Vec3<double>, 3> corners;
  DebugColor color;
};

struct Recorder final : DebugRenderer {
  std::vector<Line> lines;
  std::vector<Triangle> triangles;
  std::vector<std::string> texts;

  void line(const Vec3<double>& from, const Vec3<double>& to, DebugColor color) override {
    lines.push_back({from, to, color});
  }
  void triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                DebugColor color) override {
    triangles.push_back({{a, b, c}, color});
  }
  void text(const Vec3<double>&, const char* words, DebugColor) override { texts.emplace_back(words); }

  std::vector<Line> of(DebugColor color) const {
    std::vector<Line> some;
    std::copy_if(lines.begin(), lines.end(), std::back_inserter(some),
                 [&](const Line& l) { return l.color == color; });
    return some;
  }
  bool empty() const { return lines.empty() && triangles.empty() && texts.empty(); }
};

template <class T>
Recorder drawn(const World<T>& world, const DebugDrawSettings& settings) {
  Recorder recorder;
  draw(world, settings, recorder);
  for (const Line& l : recorder.lines) EXPECT_TRUE(l.from.allFinite() && l.to.allFinite());
  return recorder;
}

/// Stands, or has been hit on its hand.
struct Hero : Playing<float> {
  explicit Hero(bool hit) {
    step();
    if (hit) {
      const int hand = skeleton.find("hand_r");
      const Vec3<float> at = character().model()[static_cast<std::size_t>(hand)].translation;
      EXPECT_TRUE(character().apply_impulse(hand, at, {15, 0, 0}).ok());
    }
    for (int n = 0; n < 3; ++n) step();
    EXPECT_EQ(character().report().unknown_dofs > 0, hit);
  }
};

TEST(DebugDraw, NothingAskedForIsNothingDrawn) {
  const Hero hero(true);
  EXPECT_TRUE(drawn(hero.world, kNothing).empty());
}

TEST(DebugDraw, EmptyWorldAndAWorldBeforeItsFirstStepAreDrawn) {
  EXPECT_TRUE(drawn(World<double>({}), {}).empty());
  const Playing<double> scene;
  EXPECT_FALSE(drawn(scene.world, {}).empty());
}

TEST(DebugDraw, SkeletonIsALineFromEachJointToItsParent) {
  Hero hero(true);
  DebugDrawSettings bones = kNothing;
  bones.skeleton = true;
  const Recorder r = drawn(hero.world, bones);
  std::size_t line = 0;
  for (std::size_t j = 0; j < hero.skeleton.joints.size(); ++j) {
    const int parent = hero.skeleton.joints[j].parent;
    if (parent < 0) continue;
    ASSERT_LT(line, r.lines.size());
    const auto place = [&](std::size_t joint) {
      return Vec3<double>(hero.character().model()[joint].translation.cast<double>());
    };
    EXPECT_EQ(r.lines[line].from, place(static_cast<std::size_t>(parent)));
    EXPECT_EQ(r.lines[line++].to, place(j));
  }
  EXPECT_EQ(line, r.lines.size());
  EXPECT_TRUE(r.triangles.empty());
}

TEST(DebugDraw, WiresLieOnTheSurfacesOfColliders) {
  WorldSettings settings;
  for (const Shape shape : {Shape::kSphere, Shape::kCapsule, Shape::kBox}) {
    World<double> world(settings);
    Collider obstacle;
    obstacle.shape = shape;
    obstacle.size = {0.2, 0.3, 0.5};
    obstacle.local.translation = {1, 2, 3};
    obstacle.local.rotation = Quat<double>(0.5, 0.5, -0.5, 0.5);
    ASSERT_TRUE(world.add_obstacle(obstacle).ok());
    DebugDrawSettings wires = kNothing;
    wires.colliders = true;
    const Recorder r = drawn(world, wires);
    EXPECT_GE(r.lines.size(), 12u);
    for (const Line& l : r.lines) {
      EXPECT_EQ(l.color, kStatic);
      for (const Vec3<double>& end : {l.from, l.to}) {
        const Vec3<double> local = obstacle.local.inverse() * end;
        const double off = (local.cwiseAbs() - obstacle.size).maxCoeff();
        const double radius =
            std::hypot(local.x(), local.y(),
                       local.z() - (shape == Shape::kCapsule ? std::clamp(local.z(), -0.5, 0.5) : 0));
        EXPECT_NEAR(shape == Shape::kBox ? off : radius - 0.2, 0, 1e-12);
      }
    }
  }
}

TEST(DebugDraw, ColoursSayWhatTheStepDidWithTheirOwner) {
  DebugDrawSettings wires = kNothing;
  wires.colliders = true;
  const Recorder played = drawn(Hero(false).world, wires), solved = drawn(Hero(true).world, wires);
  EXPECT_EQ(played.of(kPlayed).size(), played.lines.size());
  EXPECT_EQ(solved.of(kSolved).size(), solved.lines.size());
  EXPECT_EQ(played.lines.size(), solved.lines.size());
}

TEST(DebugDraw, ForcesOfContactsAreTheWeightTheyBear) {
  World<double> world({});
  Status status;
  PropSettings box;
  box.shape = Shape::kBox;
  box.mass = 7;
  box.pose.translation = {0, 0, 0.1};
  ASSERT_EQ(world.add_prop(box, status), 0) << status.reason;
  DebugDrawSettings touches = kNothing;
  touches.contacts = true;
  touches.force_scale = 0.01;
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(world.step(1 / 60.0).ok());
  EXPECT_TRUE(drawn(world, touches).empty()) << "nobody listens";
  std::vector<ContactEvent> room(16);
  ContactRing ring(room);
  ASSERT_TRUE(report_contacts(world, &ring).ok());
  ASSERT_TRUE(world.step(1 / 60.0).ok());
  const Recorder r = drawn(world, touches);
  Vec3<double> sum = Vec3<double>::Zero();
  for (const Line& l : r.of(kForce)) sum += (l.to - l.from) / touches.force_scale;
  EXPECT_EQ(r.of(kForce).size(), 4u);
  EXPECT_EQ(r.of(kTouch).size(), 12u);
  EXPECT_NEAR((sum - Vec3<double>(0, 0, 7 * 9.81)).norm(), 0, 1e-3 * 7 * 9.81);
}

TEST(DebugDraw, AxesAreDrawnForEveryUnknownAndForNothingElse) {
  DebugDrawSettings axes = kNothing;
  axes.unknowns = true;
  EXPECT_TRUE(drawn(Hero(false).world, axes).empty());
  Hero hit(true);
  const Recorder r = drawn(hit.world, axes);
  EXPECT_EQ(static_cast<int>(r.lines.size()), hit.character().report().unknown_dofs);
  for (const Line& l : r.lines) EXPECT_GT((l.to - l.from).norm(), 0.05);
}

TEST(DebugDraw, MusclesAreRedAtTheirLimitAndGreenWithoutALoad) {
  DebugDrawSettings marks = kNothing;
  marks.muscles = true;
  Hero hit(true);
  const auto load = hit.character().load();
  const double most = double(*std::max_element(load.begin(), load.end()));
  ASSERT_GT(most, 0.95) << "the blow was to be more than a muscle bears";
  int reddest = 0, greenest = 255;
  for (const Triangle& t : drawn(hit.world, marks).triangles) {
    reddest = std::max(reddest, int(t.color.r) - int(t.color.g));
    greenest = std::min(greenest, int(t.color.r));
  }
  EXPECT_GT(reddest, 200);
  EXPECT_LT(greenest, 100);
}

TEST(DebugDraw, TargetsAreDrawnWhereThePoseIsNotOnThem) {
  DebugDrawSettings targets = kNothing;
  targets.targets = true;
  EXPECT_TRUE(drawn(Hero(false).world, targets).empty());
  const Recorder r = drawn(Hero(true).world, targets);
  EXPECT_FALSE(r.lines.empty());
  EXPECT_EQ(r.of(kTarget).size(), r.lines.size());
}

TEST(DebugDraw, SupportIsTheHullOfWhatStandsUnderTheCentreOfMass) {
  Hero hero(false);
  DebugDrawSettings support = kNothing;
  support.support = true;
  const Recorder r = drawn(hero.world, support);
  const std::vector<Line> center = r.of(kCenter);
  ASSERT_EQ(center.size(), 4u);
  const Vec3<double> foot = center[3].to;
  EXPECT_EQ(foot.z(), 0);
  ASSERT_FALSE(r.triangles.empty()) << "the figure was to stand";
  bool within = false;
  double area = 0;
  for (const Triangle& t : r.triangles) {
    const auto cross = [](const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
      return (b - a).cross(c - a).z();
    };
    const auto& [a, b, c] = t.corners;
    area += cross(a, b, c) / 2;
    within = within || (cross(a, b, foot) >= 0 && cross(b, c, foot) >= 0 && cross(c, a, foot) >= 0);
  }
  EXPECT_TRUE(within);
  EXPECT_GT(area, 0.01);
}

TEST(DebugDraw, IslandsJoinThoseSolvedTogetherAndWordsSayWhatWasDone) {
  Hero hit(true);
  DebugDrawSettings islands = kNothing;
  islands.islands = true;
  Recorder r = drawn(hit.world, islands);
  ASSERT_EQ(r.texts.size(), 1u);
  const CharacterReport& report = hit.character().report();
  EXPECT_NE(r.texts[0].find(std::to_string(report.unknown_dofs) + " of " + std::to_string(report.dofs)),
            std::string::npos);
  EXPECT_TRUE(r.lines.empty());
  World<float> world({});
  Status status;
  for (const double x : {0.0, 0.21, 5.0}) {
    PropSettings ball;
    ball.pose.translation = {x, 0, 0.1};
    ASSERT_GE(world.add_prop(ball, status), 0) << status.reason;
  }
  ASSERT_TRUE(world.step(1 / 60.f).ok());
  EXPECT_EQ(drawn(world, islands).lines.size(), 1u);
}

TEST(DebugDraw, WhatIsParkedIsNotDrawn) {
  Hero hero(false);
  ASSERT_TRUE(hero.world.park_character(0).ok());
  EXPECT_TRUE(drawn(hero.world, {}).empty());
}

TEST(DebugDraw, ChangesNoBitOfTheWorld) {
  Playing<float> seen, unseen;
  const int hand = seen.skeleton.find("hand_r");
  for (int n = 0; n < 60; ++n) {
    for (Playing<float>* scene : {&seen, &unseen}) {
      if (n % 20 == 5) {
        EXPECT_TRUE(scene->character().apply_impulse(hand, {0, 0, 1}, {10, 0, 0}).ok());
      }
      scene->step();
    }
    (void)drawn(seen.world, {});
    std::vector<std::byte> a(seen.world.snapshot_capacity()), b(a.size());
    a.resize(seen.world.save(a));
    b.resize(unseen.world.save(b));
    ASSERT_EQ(a, b) << "step " << n;
  }
}

}  // namespace
}  // namespace sinew
