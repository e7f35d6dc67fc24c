// A population: who is pushed, too weak or touched is solved in the world, the rest is checked in batches.
#include "sinew/crowd/population.h"

#include <cstring>

#include "character/scenes.h"
#include "fixtures/clips.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"

namespace sinew {
namespace {

constexpr float kStep = 1 / 60.f;

struct People {
  Skeleton rig = fixtures::humanoid();
  Clip clip = fixtures::swaying_clip(rig, 1, 0.05);
  std::unique_ptr<Population> population;
  int count;

  explicit People(int characters, float spacing = 3, int places = 8, int workers = 1, double strength = 1)
      : count(characters) {
    PopulationSettings settings;
    settings.crowd.capacity = count;
    settings.crowd.chunks = workers;
    settings.world.workers = workers;
    settings.character.strength = strength;
    settings.places = std::min(places, count);
    Status status;
    population = Population::create(rig, settings, status);
    EXPECT_TRUE(population) << status.reason;
    for (int n = 0; n < count; ++n) {
      Transform<float> place;
      place.translation = {0, spacing * float(n), 0};
      EXPECT_TRUE(population->play(n, {&clip, 0.1 * n, place}).ok());
    }
  }
  void step(const ParallelFor& parallel_for = {}) const {
    ASSERT_TRUE(population->step(kStep, parallel_for).ok());
  }
  std::vector<Transform<float>> pose(int n) const {
    return {population->model(n).begin(), population->model(n).end()};
  }
};

TEST(Population, UndisturbedCharactersNeverEnterTheWorld) {
  People people(20);
  for (int n = 0; n < 120; ++n) {
    people.step();
    ASSERT_EQ(people.population->solved_count(), 0) << n;
  }
}

TEST(Population, ThePushedIsSolvedInTheSameStepReturnsAndLeaves) {
  People people(6), calm(6);
  for (int n = 0; n < 10; ++n) {
    people.step();
    calm.step();
  }
  const int hand = people.rig.find("hand_r");
  ASSERT_TRUE(people.population->push(2, hand, {15, 0, 0}).ok());
  people.step();
  calm.step();
  EXPECT_EQ(people.population->level(2), Level::kSubsteps);  // a hand is flung
  EXPECT_NE(people.pose(2), calm.pose(2));
  int steps = 0;
  while (people.population->in_world(2) && steps < 300) {
    people.step();
    calm.step();
    ++steps;
    for (int n : {0, 1, 3, 5}) ASSERT_EQ(people.pose(n), calm.pose(n)) << "nobody else notices";
  }
  EXPECT_GT(steps, 60) << "a second after it was last solved";
  EXPECT_LT(steps, 240);
  EXPECT_EQ(people.pose(2), calm.pose(2));
}

TEST(Population, WhoIsTooWeakForTheClipEntersWithItsPoseAndSpeed) {
  People weak(2, 3, 2, 1, 0.001), strong(2);
  weak.step();
  strong.step();
  ASSERT_TRUE(weak.population->in_world(1));
  EXPECT_GT(weak.population->level(1), Level::kChecked);
  float most = 0;
  for (std::size_t i = 0; i < weak.rig.joints.size(); ++i)
    most = std::max(most, (weak.pose(1)[i].translation - strong.pose(1)[i].translation).norm());
  EXPECT_GT(most, 1e-5f) << "was to give way";
  EXPECT_LT(most, 0.01f) << "within a step gravity makes 1.4 mm of a free fall, and no start from rest shows";
}

TEST(Population, NeighboursOfOneWhoFallsAreCalledBeforeTheyAreTouched) {
  People people(3, 1.2f);
  people.step();
  ASSERT_TRUE(people.population->push(0, 0, {0, 250, 0}).ok());  // at its neighbour, however it falls
  (void)people.population->solved(0).set_root_drive(RootDrive::kFree);
  ASSERT_TRUE(people.population->solved(0).set_strength(0.02f).ok());
  bool called = false, moved = false;
  for (int n = 0; n < 90; ++n) {
    people.step();
    called = called || people.population->in_world(1);
    moved = moved || people.population->level(1) > Level::kChecked;
  }
  EXPECT_TRUE(called);
  EXPECT_TRUE(moved) << "was hit by the falling one";
}

TEST(Population, AThrownBallHitsOneWhoseNeighboursNoticeNothing) {
  People people(6), calm(6);
  PropSettings ball;
  ball.mass = 8;
  ball.size = Vec3<double>::Constant(0.12);
  ball.pose.translation = {-3, 6.1, 0.65};  // at a leg: the root goes where it wants
  ball.velocity = {14, 0, 0.5};
  Status status;
  ASSERT_EQ(people.population->world().add_prop(ball, status), 0) << status.reason;
  int first = -1;
  float most = 0;
  for (int n = 0; n < 40; ++n) {
    people.step();
    calm.step();
    for (std::size_t i = 0; i < people.rig.joints.size(); ++i)
      most = std::max(most, (people.pose(2)[i].translation - calm.pose(2)[i].translation).norm());
    if (first < 0 && people.population->level(2) > Level::kChecked) first = n;
    for (int c : {0, 1, 3, 4, 5}) ASSERT_EQ(people.pose(c), calm.pose(c)) << c;
  }
  EXPECT_GT(first, 5) << "before it comes, only watched";
  EXPECT_LT(first, 20);
  EXPECT_LT(people.population->world().prop_velocity(0).x(), 8) << "it was stopped";
  EXPECT_GT(most, 0.02f);
}

TEST(Population, AFullWorldTurnsAwayAndSaysSo) {
  People people(4, 3, 2);
  people.step();
  EXPECT_TRUE(people.population->push(0, 1, {5, 0, 0}).ok());
  EXPECT_TRUE(people.population->push(1, 1, {5, 0, 0}).ok());
  EXPECT_EQ(people.population->push(2, 1, {5, 0, 0}).code, Code::kOutOfRange);
  ASSERT_TRUE(people.population->crowd().set_strength(3, 0.f).ok());
  people.step();
  EXPECT_EQ(people.population->turned_away(), 1);
  EXPECT_FALSE(people.population->in_world(3));
}

TEST(Population, RefusesWhatCannotBeMeant) {
  People people(4);
  EXPECT_FALSE(people.population->push(4, 0, {1, 0, 0}).ok());
  EXPECT_FALSE(people.population->push(0, 99, {1, 0, 0}).ok());
  EXPECT_FALSE(people.population->play(0, {}).ok());
  EXPECT_FALSE(people.population->step(0).ok());
  EXPECT_FALSE(people.population->step(std::nanf("")).ok());
  PopulationSettings settings;
  settings.crowd.capacity = 4;
  settings.places = 5;
  Status status;
  EXPECT_FALSE(Population::create(people.rig, settings, status));
  EXPECT_FALSE(status.ok());
}

TEST(Population, AnyNumberOfThreadsGivesTheSameBits) {
  for (int threads : {1, 2, 4, 7}) {
    People many(30, 2, 8, threads), alone(30, 2);
    for (int n = 0; n < 40; ++n) {
      for (People* people : {&many, &alone}) {
        if (n % 8 != 2) continue;
        EXPECT_TRUE(people->population->push(3 * n % 30, 4, {20, 9, 0}).ok());
      }
      many.step({fixtures::run_on_threads, &threads});
      alone.step();
      for (int c = 0; c < 30; ++c)
        ASSERT_EQ(many.pose(c), alone.pose(c)) << threads << " threads, step " << n;
    }
  }
}

TEST(Population, StepAndPushAllocateNothing) {
  People people(20, 2, 8, 3);
  fixtures::Shuffled shuffled;
  people.step(shuffled.parallel_for());
  const long before = fixtures::allocations;
  for (int n = 0; n < 60; ++n) {
    if (n % 10 == 0) (void)people.population->push(n / 4, 4, {25, 9, 0});
    (void)people.population->step(kStep, shuffled.parallel_for());
  }
  EXPECT_EQ(fixtures::allocations - before, 0);
}

}  // namespace
}  // namespace sinew
