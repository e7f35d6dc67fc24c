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

TEST(Population, WhoIsWeakIsAsWeakInTheWorldAndWhoComesInHisPlaceIsNot) {
  People people(2, 1);
  ASSERT_TRUE(people.population->set_strength(1, 0.001f));
  people.step();
  ASSERT_TRUE(people.population->in_world(1));
  EXPECT_EQ(people.population->solved(1).strength(), 0.001f);
  ASSERT_TRUE(people.population->set_strength(1, 0.5f));
  EXPECT_EQ(people.population->solved(1).strength(), 0.5f) << "at once";
  ASSERT_TRUE(people.population->stop(1));
  ASSERT_TRUE(people.population->push(0, 2, {20, 0, 0}));
  ASSERT_TRUE(people.population->in_world(0));
  EXPECT_EQ(people.population->solved(0).strength(), 1);
  EXPECT_FALSE(people.population->set_strength(2, 1)) << "there is none";
  EXPECT_FALSE(people.population->set_strength(0, -1));
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

/// With a ball on its way to one of them.
struct Disturbed : People {
  Disturbed() : People(12, 1.5f, 6) {
    Status status;
    PropSettings ball;
    ball.mass = 8;
    ball.size = Vec3<double>::Constant(0.12);
    ball.pose.translation = {-3, 3.1, 0.65};
    ball.velocity = {11, 0, 0.5};
    EXPECT_EQ(population->world().add_prop(ball, status), 0) << status.reason;
  }
};

/// One is pushed, one too weak, one goes, one is pushed later.
void disturb(const People& people, int frame) {
  Population& population = *people.population;
  Status status;
  if (frame == 3) status = population.push(4, people.rig.find("hand_r"), {15, 0, 0});
  if (frame == 8) status = population.crowd().set_strength(9, 0.001f);
  if (frame == 12) status = population.stop(11);
  if (frame == 40) status = population.push(6, people.rig.find("hand_l"), {0, 15, 0});
  EXPECT_TRUE(status) << status.reason;
}

TEST(Population, GoesOnFromASnapshotToTheBit) {
  const Disturbed people, other;
  const std::span<const Clip> clips(&people.clip, 1), of_other(&other.clip, 1);
  std::vector<std::byte> bytes(people.population->snapshot_capacity());
  std::size_t size = 0;
  int solved = 0;
  std::vector<std::vector<Transform<float>>> wanted;
  for (int frame = 0; frame < 120; ++frame) {
    if (frame == 20) {
      ASSERT_TRUE(people.population->save(clips, bytes, size));
      solved = people.population->solved_count();
      for (int c = 0; c < people.count; ++c) wanted.push_back(people.pose(c));
    }
    disturb(people, frame);
    people.step();
    for (int c = 0; c < people.count && frame >= 20; ++c) wanted.push_back(people.pose(c));
  }
  EXPECT_GE(solved, 2);
  for (const Disturbed* with : {&people, &other}) {  // of another moment, and a new one
    ASSERT_TRUE(with->population->restore(with == &other ? of_other : clips, std::span(bytes).first(size)));
    EXPECT_EQ(with->population->solved_count(), solved);
    std::size_t n = 0;
    for (int c = 0; c < with->count; ++c) ASSERT_EQ(with->pose(c), wanted[n++]) << c << " at once";
    for (int frame = 20; frame < 120; ++frame) {
      disturb(*with, frame);
      with->step();
      for (int c = 0; c < with->count; ++c) ASSERT_EQ(with->pose(c), wanted[n++]) << c << " in " << frame;
    }
  }
}

TEST(Population, RefusesSnapshotsThatAreNotItsOwnWithNothingMoved) {
  const Disturbed people;
  const People few(5, 3, 5), four_places(12, 1.5f, 4);
  const std::span<const Clip> clips(&people.clip, 1);
  for (int frame = 0; frame < 20; ++frame) {
    disturb(people, frame);
    people.step();
  }
  std::vector<std::byte> bytes(people.population->snapshot_capacity());
  std::size_t size = 0;
  EXPECT_EQ(people.population->save(clips, std::span(bytes).first(100), size).code, Code::kOutOfRange);
  EXPECT_EQ(size, 0u);
  EXPECT_EQ(people.population->save({}, bytes, size).index, 0) << "who plays a clip that is not there";
  ASSERT_TRUE(people.population->save(clips, bytes, size));
  bytes.resize(size);
  people.step();
  const std::vector<Transform<float>> before = people.pose(4);
  EXPECT_FALSE(few.population->restore(clips, bytes));
  EXPECT_FALSE(four_places.population->restore(clips, bytes));
  EXPECT_FALSE(people.population->restore({}, bytes));
  Clip other = people.clip;
  --other.joint_count;
  EXPECT_FALSE(people.population->restore(std::span<const Clip>(&other, 1), bytes));
  for (std::size_t n = 0; n < size; n += 1 + n / 40) {
    EXPECT_FALSE(people.population->restore(clips, std::span(bytes).first(n))) << n;
    bytes[n] ^= std::byte{4};
    EXPECT_FALSE(people.population->restore(clips, bytes)) << n;
    bytes[n] ^= std::byte{4};
  }
  EXPECT_EQ(people.pose(4), before);
  EXPECT_TRUE(people.population->restore(clips, bytes));
  EXPECT_NE(people.pose(4), before);
}

TEST(Population, WhoStopsIsGoneUntilHePlaysAgain) {
  const People people(3);
  people.step();
  const int hand = people.rig.find("hand_r");
  ASSERT_TRUE(people.population->push(1, hand, {15, 0, 0}));
  people.step();
  ASSERT_TRUE(people.population->in_world(1));
  ASSERT_TRUE(people.population->stop(1));
  EXPECT_FALSE(people.population->in_world(1));
  EXPECT_FALSE(people.population->push(1, hand, {15, 0, 0})) << "nobody is there";
  const std::vector<Transform<float>> at_rest = people.pose(1);
  people.step();
  EXPECT_EQ(people.pose(1), at_rest);
  ASSERT_TRUE(people.population->play(1, {&people.clip}));
  people.step();
  EXPECT_NE(people.pose(1), at_rest);
  EXPECT_FALSE(people.population->stop(3));
}

TEST(Population, StepPushSaveAndRestoreAllocateNothing) {
  People people(20, 2, 8, 3);
  fixtures::Shuffled shuffled;
  people.step(shuffled.parallel_for());
  const std::span<const Clip> clips(&people.clip, 1);
  std::vector<std::byte> bytes(people.population->snapshot_capacity());
  std::size_t size = 0;
  const long before = fixtures::allocations;
  for (int n = 0; n < 60; ++n) {
    if (n % 10 == 0) (void)people.population->push(n / 4, 4, {25, 9, 0});
    (void)people.population->step(kStep, shuffled.parallel_for());
    if (n == 30) (void)people.population->save(clips, bytes, size);
    if (n == 45) (void)people.population->restore(clips, std::span(bytes).first(size));
  }
  EXPECT_EQ(fixtures::allocations - before, 0);
}

}  // namespace
}  // namespace sinew
