// What does not touch changes nothing: whoever is near a character, but never comes close, leaves its motion
// to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "character/scenes.h"
#include "fixtures/pile.h"
#include "fixtures/platform.h"
#include "sinew/character/prop.h"

namespace sinew {
namespace {

constexpr float kStep = 1.f / 60;

struct Scene {
  World<float> world{WorldSettings()};

  /// A limp figure, its limbs thrown about, over a place on the floor. `seed` says how.
  int fall(const Vec3<float>& place, unsigned seed) {
    CharacterSettings limp;
    limp.root = RootDrive::kFree;
    limp.strength = 0;
    const Skeleton body = fixtures::humanoid();
    Status status;
    const int n = world.add_character(body, limp, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    const std::vector<JointJet<float>> jets = fixtures::upright_jets(body, static_cast<int>(seed), place);
    EXPECT_TRUE(world.character(n).set_target(jets).ok());
    (void)world.character(n).reset();
    return n;
  }
  int box(const Vec3<double>& place, const Vec3<double>& velocity, const Vec3<double>& spin) {
    PropSettings box;
    box.shape = Shape::kBox;
    box.size = {0.1, 0.15, 0.2};
    box.mass = 5;
    box.pose.translation = place;
    box.velocity = velocity;
    box.angular_velocity = spin;
    Status status;
    const int n = world.add_prop(box, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    return n;
  }
};

using Poses = std::vector<Transform<float>>;

/// The poses of what `watched` reads, after each of so many steps.
Poses record(Scene& scene, int steps, const std::function<Poses()>& watched) {
  Poses all;
  for (int n = 0; n < steps; ++n) {
    EXPECT_TRUE(scene.world.step(kStep).ok());
    const Poses now = watched();
    all.insert(all.end(), now.begin(), now.end());
  }
  return all;
}

Poses record_character(Scene& scene, int character, int steps) {
  return record(scene, steps, [&] {
    const auto model = scene.world.character(character).model();
    return Poses(model.begin(), model.end());
  });
}

Poses record_box(Scene& scene, int box, int steps) {
  return record(scene, steps, [&] { return Poses{scene.world.prop_pose(box)}; });
}

/// m, the furthest that anything is from where it is in the other.
double apart(const Poses& a, const Poses& b) {
  EXPECT_EQ(a.size(), b.size());
  double furthest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double turned = (a[i].rotation.coeffs() - b[i].rotation.coeffs()).norm();
    furthest = std::max({furthest, double((a[i].translation - b[i].translation).norm()), turned});
  }
  return furthest;
}

constexpr float kAbove = 2;  // m
const Vec3<float> kHere(0, 0, kAbove), kBeside(0, 2, kAbove);

TEST(Bystander, AFallBesideAFallIsAsAlone) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    Scene alone, two;
    const Poses wanted = record_character(alone, alone.fall(kHere, seed), 60);
    const int n = two.fall(kHere, seed);
    two.fall(kBeside, seed + 10);
    EXPECT_EQ(apart(record_character(two, n, 60), wanted), 0) << seed;
  }
}

TEST(Bystander, AFallBehindAnotherInTheListIsAsAlone) {
  Scene alone, two;
  const Poses wanted = record_character(alone, alone.fall(kHere, 1), 60);
  two.fall(kBeside, 11);
  EXPECT_EQ(apart(record_character(two, two.fall(kHere, 1), 60), wanted), 0);
}

TEST(Bystander, ASpinningBoxBesideATumblingFigureKeepsItsSpin) {
  Scene alone, two;
  const Vec3<double> place(0.6, 0, 2);
  const Poses wanted = record_box(alone, alone.box(place, {0, 0, 3}, {0, 0, 20}), 40);
  const int box = two.box(place, {0, 0, 3}, {0, 0, 20});
  two.fall(kHere, 3);
  EXPECT_EQ(apart(record_box(two, box, 40), wanted), 0);
}

TEST(Bystander, AFallBesideFourInOnePlaceFallsAtG) {
  Scene alone, many;
  const Vec3<float> beside(0, 2.5f, kAbove);
  const Poses wanted = record_character(alone, alone.fall(beside, 7), 12);
  const int n = many.fall(beside, 7);
  for (unsigned k = 0; k < 4; ++k) many.fall({0, 0, kAbove}, k);
  EXPECT_EQ(apart(record_character(many, n, 12), wanted), 0);
}

TEST(Bystander, DetailOfTheOtherChangesNothing) {
  Scene full, capped;
  std::vector<Poses> poses;
  for (Scene* scene : {&full, &capped}) {
    const int n = scene->fall(kHere, 5), other = scene->fall({0, 3, kAbove}, 6);
    CharacterDetail detail;
    if (scene == &capped) detail.most = Level::kPartial;
    EXPECT_TRUE(scene->world.character(other).set_detail(detail).ok());
    poses.push_back(record_character(*scene, n, 60));
  }
  EXPECT_EQ(apart(poses[0], poses[1]), 0);
}

TEST(Bystander, ABoxSlidesPastAFallenFigureAsAlone) {
  Scene alone, two;
  const Vec3<double> place(-1.5, 0, 0.2), velocity(4, 0, 0);
  const Poses wanted = record_box(alone, alone.box(place, velocity, Vec3<double>::Zero()), 90);
  const int box = two.box(place, velocity, Vec3<double>::Zero());
  two.fall({0, 1.4f, 1}, 2);
  EXPECT_EQ(apart(record_box(two, box, 90), wanted), 0);
}

/// Steps of a second in which an idle figure is not played but solved, with an obstacle in its world.
int solved_beside(const Vec3<double>& place) {
  fixtures::Playing<float> figure;
  Collider obstacle;
  obstacle.shape = Shape::kBox;
  obstacle.size = Vec3<double>::Constant(0.25);
  obstacle.local.translation = place;
  EXPECT_TRUE(figure.world.add_obstacle(obstacle).ok());
  int solved = 0;
  for (int n = 0; n < 60; ++n) {
    figure.step();
    solved += figure.character().report().substeps > 0;
  }
  return solved;
}

TEST(Bystander, AnObstacleBesideAFigureDoesNotEndItsPlayback) {
  EXPECT_EQ(solved_beside({0, 0.9, 1.2}), 0);
  EXPECT_EQ(solved_beside({0.65, 0, 0.9}), 0);
  EXPECT_GT(solved_beside({0.2, 0, 1.2}), 50) << "in its chest";
}

TEST(Bystander, AnObstacleEndsPlaybackOnlyWhereTheAnimationMeetsIt) {
  EXPECT_EQ(solved_beside({0, 0.65, 1.1}), 0) << "a hand's breadth beside the arm";
  EXPECT_EQ(solved_beside({0.42, 0, 1.1}), 0) << "before the chest";
}

TEST(Bystander, AFallTwoHandsBesideAFallIsAsAloneUntilTheyTouch) {
  Scene alone, two;
  const Vec3<double> near(0.55, 0, 2.2);
  const Poses wanted = record_character(alone, alone.fall(kHere, 4), 12);
  const int n = two.fall(kHere, 4);
  two.box(near, {0, 0, 0.5}, {2, 3, 1});  // falls along, centimetres off
  EXPECT_EQ(apart(record_character(two, n, 12), wanted), 0);
}

/// Steps of two figures that idle for two seconds in which one of them is not played but solved. `lead` moves
/// a root: of whom (0, 1), at which time (s).
int solved_of_two(const std::function<void(int, float, JointJet<float>&)>& lead) {
  World<float> world{WorldSettings()};
  const Skeleton body = fixtures::humanoid();
  Status status;
  for (int n = 0; n < 2; ++n) EXPECT_EQ(world.add_character(body, {}, status), n) << status.reason;
  int solved = 0;
  for (int step = 0; step < 120; ++step) {
    for (int n = 0; n < 2; ++n) {
      const float time = float(step) * kStep;
      std::vector<JointJet<float>> jets = fixtures::idle<float>(body, double(time) + n);
      lead(n, time, jets[0]);
      EXPECT_TRUE(world.character(n).set_target(jets).ok());
      if (step == 0) (void)world.character(n).reset();
    }
    EXPECT_TRUE(world.step(kStep).ok());
    for (int n = 0; n < 2; ++n) solved += world.character(n).report().substeps > 0;
  }
  return solved;
}

TEST(Bystander, WhoPassesAtArmsLengthIsPlayedAndEndsNobodysPlayback) {
  const auto passes = [](float beside) {
    return solved_of_two([beside](int n, float time, JointJet<float>& root) {
      const float pace = n == 0 ? 1.5f : -1.5f;
      root.translation += Vec3<float>(pace * (time - 1), beside * float(n), 0);
      root.velocity.x() += pace;
    });
  };
  EXPECT_EQ(passes(0.8f), 0);
  EXPECT_GT(passes(0.2f), 10) << "through each other's arms";
}

TEST(Bystander, ABallThatStrikesEndsPlaybackInThatStep) {
  fixtures::Playing<float> figure;
  PropSettings ball;
  ball.size = {0.1, 0, 0};
  ball.mass = 3;
  ball.pose.translation = {0.8, 0, 1.2};
  ball.velocity = {-10, 0, 0};
  Status status;
  ASSERT_EQ(figure.world.add_prop(ball, status), 0) << status.reason;
  int first = -1;
  for (int n = 0; n < 10; ++n) {
    figure.step();
    if (first < 0 && figure.character().report().substeps > 0) first = n;
    const float front = figure.world.prop_pose(0).translation.x();
    EXPECT_GT(front, 0.1f) << "not through the chest, step " << n;
  }
  EXPECT_GE(first, 2);
  EXPECT_LE(first, 5);
}

TEST(Bystander, WhoStandsASpanAwayDoesNotEndPlaybackEither) {
  EXPECT_EQ(
      solved_of_two([](int n, float, JointJet<float>& root) { root.translation.x() += 0.7f * float(n); }), 0);
}

/// A box that is led upwards, its top 0.3 m above the floor at first.
struct Lift {
  World<float>& world;
  int box = -1;

  explicit Lift(World<float>& in) : world(in) {
    Status status;
    box = world.add_character(fixtures::platform({6, 6, 0.15}), {}, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    lead(0);
    (void)world.character(box).reset();
  }
  void lead(float time) {
    JointJet<float> at;
    at.translation = Vec3<float>(0, 0, 0.15f + 0.5f * time);
    at.velocity = Vec3<float>(0, 0, 0.5f);
    EXPECT_TRUE(world.character(box).set_target({&at, 1}).ok());
  }
};

/// Poses of a figure that falls onto a lift, and of the lift, with others on it or not.
Poses falls_on_lift(bool others) {
  Scene scene;
  Lift lift(scene.world);
  const int watched = scene.fall({0, 0, 0.6f}, 1);
  if (others) {
    scene.fall({3, 0, 0.6f}, 2);
    scene.fall({-3, 1, 0.9f}, 3);
    scene.box({0, 4, 0.8}, {1, 0, 0}, {0, 3, 0});
  }
  float time = 0;
  return record(scene, 90, [&] {
    lift.lead(time += kStep);
    const auto model = scene.world.character(watched).model();
    Poses now(model.begin(), model.end());
    now.push_back(scene.world.character(lift.box).model()[0]);
    return now;
  });
}

TEST(Bystander, WhatCarriesSeveralMakesThemNoneOfEachOthersConcern) {
  const Poses alone = falls_on_lift(false), among = falls_on_lift(true);
  ASSERT_EQ(alone.size(), among.size());
  for (std::size_t n = 0; n < alone.size(); ++n) {
    ASSERT_EQ(alone[n].translation, among[n].translation) << n;
    ASSERT_EQ(alone[n].rotation.coeffs(), among[n].rotation.coeffs()) << n;
  }
}

}  // namespace
}  // namespace sinew
