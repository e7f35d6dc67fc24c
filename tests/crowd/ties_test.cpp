// Loops and particle bodies among many: threads, sleep, caps, limits of islands and of memory.
#include "character/scenes.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"
#include "sinew/effects/strand.h"

namespace sinew {
namespace {

using fixtures::humanoid;
using fixtures::idle;

constexpr float kStep = 1 / 60.f;

Anchor on_prop(int index) {
  Anchor anchor;
  anchor.kind = AnchorKind::kProp;
  anchor.index = index;
  return anchor;
}

int add_rope(World<float>& world, int a, int b, double length, LoopKind kind = LoopKind::kRope) {
  LoopSettings rope;
  rope.kind = kind;
  rope.a = on_prop(a);
  rope.b = on_prop(b);
  rope.length = length;
  Status status;
  const int loop = world.add_loop(rope, status);
  EXPECT_GE(loop, 0) << status.reason;
  return loop;
}

int add_ball(World<float>& world, const Vec3<double>& at, Shape shape = Shape::kSphere) {
  PropSettings ball;
  ball.shape = shape;
  ball.pose.translation = at;
  Status status;
  const int index = world.add_prop(ball, status);
  EXPECT_GE(index, 0) << status.reason;
  return index;
}

int add_plait(World<float>& world, int character, Status& status) {
  StrandSettings strand;
  strand.frame.kind = AnchorKind::kCharacter;
  strand.frame.index = character;
  strand.direction = {-1, 0, 0};
  strand.particles = 6;
  return world.add_particles(make_strand(strand), status);
}

/// Characters in a row, every other one with a plait, and balls in pairs on ropes between them.
struct Scene {
  Skeleton skeleton = humanoid();
  World<float> world;
  std::vector<std::vector<JointJet<float>>> targets;  ///< [frame · kCharacters + character]
  int frame = 0;
  static constexpr int kCharacters = 8, kFrames = 60;

  explicit Scene(const WorldSettings& settings) : world(settings) {
    Status status;
    for (int n = 0; n < kFrames * kCharacters; ++n) {
      const int time = n / kCharacters, character = n % kCharacters;
      targets.push_back(idle<float>(skeleton, time / 60.0 + character));
      targets.back()[0].translation.y() += 2.f * float(character);
    }
    for (int n = 0; n < kCharacters; ++n) {
      EXPECT_EQ(world.add_character(skeleton, {}, status), n) << status.reason;
      EXPECT_TRUE(world.character(n).set_target(targets[n]).ok());
      (void)world.character(n).reset();
      if (n % 2 == 0) {
        EXPECT_GE(add_plait(world, n, status), 0) << status.reason;
      }
      const int one = add_ball(world, {3, 2.0 * n, 1}), two = add_ball(world, {3.4, 2.0 * n, 1.5});
      add_rope(world, one, two, 0.5);
    }
  }
  void step(const ParallelFor& parallel_for) {
    for (int n = 0; n < kCharacters; ++n)
      (void)world.character(n).set_target(targets[frame * kCharacters + n]);
    ++frame;
    (void)world.step(kStep, parallel_for);
  }
  std::vector<std::byte> snapshot() const {
    std::vector<std::byte> bytes(world.snapshot_capacity());
    bytes.resize(world.save(bytes));
    return bytes;
  }
};

TEST(Ties, AnyNumberOfThreadsAndAnyOrderGiveTheSameBits) {
  const auto run = [](int workers, const ParallelFor& parallel_for) {
    WorldSettings settings;
    settings.workers = workers;
    Scene scene(settings);
    for (int n = 0; n < Scene::kFrames; ++n) scene.step(parallel_for);
    return scene.snapshot();
  };
  const auto alone = run(1, {});
  for (int threads : {2, 4, 7}) EXPECT_EQ(run(threads, {fixtures::run_on_threads, &threads}), alone);
  fixtures::Shuffled shuffled;
  EXPECT_EQ(run(5, shuffled.parallel_for()), alone);
}

TEST(Ties, StepAllocatesNothing) {
  WorldSettings settings;
  settings.workers = 4;
  Scene scene(settings);
  fixtures::Shuffled shuffled;
  const long before = fixtures::allocations;
  for (int n = 0; n < Scene::kFrames; ++n) scene.step(shuffled.parallel_for());
  EXPECT_EQ(fixtures::allocations - before, 0);
}

TEST(Ties, AccountOfMemoryIsWhatTheHeapGave) {
  WorldSettings settings;
  settings.workers = 3;
  const std::size_t before = fixtures::bytes_in_use;
  World<float> world(settings);
  Status status;
  for (int n = 0; n < 10; ++n) {
    ASSERT_EQ(world.add_character(humanoid(), {}, status), n) << status.reason;
    ASSERT_EQ(add_plait(world, n, status), n) << status.reason;
  }
  const double heap = double(fixtures::bytes_in_use - before), said = double(world.memory().total());
  EXPECT_NEAR(said / heap, 1, 0.15) << heap << " bytes; names and lists of indices are left out";
}

TEST(Ties, CapOnTheMemoryHoldsForThemTooAndLeavesNothingHalfDone) {
  WorldSettings settings;
  Status status;
  {
    World<float> world(settings);
    ASSERT_EQ(world.add_character(humanoid(), {}, status), 0);
    settings.memory_cap = world.memory().total() + 100'000;
  }
  World<float> world(settings);
  ASSERT_EQ(world.add_character(humanoid(), {}, status), 0);
  int count = 0;
  while (count < 1000 && add_plait(world, 0, status) >= 0) ++count;
  EXPECT_LT(count, 100);
  EXPECT_EQ(status.code, Code::kOutOfRange);
  EXPECT_EQ(world.particles_count(), count);
  EXPECT_LE(world.memory().total(), settings.memory_cap);
  EXPECT_TRUE(world.step(kStep).ok());
}

TEST(Ties, WhoWearsParticlesIsSolvedEvenWhereItMayOnlyPlay) {
  World<float> world({});
  Status status;
  const Skeleton skeleton = humanoid();
  CharacterSettings settings;
  settings.detail.most = Level::kPlayback;
  for (int n = 0; n < 2; ++n) ASSERT_EQ(world.add_character(skeleton, settings, status), n) << status.reason;
  ASSERT_EQ(add_plait(world, 0, status), 0) << status.reason;
  for (int frame = 0; frame < 30; ++frame) {
    for (int n = 0; n < 2; ++n) {
      auto jets = idle<float>(skeleton, 0);
      jets[0].translation += Vec3<float>(float(frame) / 60, 4.f * float(n), 0);
      jets[0].velocity = {1, 0, 0};
      ASSERT_TRUE(world.character(n).set_target(jets).ok());
      if (frame == 0) (void)world.character(n).reset();
    }
    if (frame == 0) (void)world.reset_particles(0, {1, 0, 0});
    ASSERT_TRUE(world.step(kStep).ok());
  }
  EXPECT_GT(world.character(0).report().substeps, 0) << "the wearer was not solved";
  EXPECT_EQ(world.character(1).report().substeps, 0) << "the other one may only play";
  // Half a metre on, the tip hangs within the strand's 0.3 m (and what it gives) of the root that it is
  // fixed to.
  const Vec3<float> root = world.character(0).model()[0].translation;
  EXPECT_LT((world.particle(0, 6) - root).norm(), 0.32f);
}

TEST(Ties, ClosingALoopBetweenSleepersWakesBothAndOpeningItLetsThemFallAsleep) {
  WorldSettings settings;
  settings.detail.sleep_after = 0.25;
  World<float> world(settings);
  // Boxes: balls would roll on.
  const int one = add_ball(world, {0, 0, 0.1}, Shape::kBox), two = add_ball(world, {3, 0, 0.1}, Shape::kBox);
  const int loop = add_rope(world, one, two, 2.5);
  (void)world.set_loop(loop, false);
  const auto asleep = [&](int n) { return world.prop_report(n).level == Level::kAsleep; };
  for (int n = 0; n < 300 && !(asleep(one) && asleep(two)); ++n) ASSERT_TRUE(world.step(kStep).ok());
  ASSERT_TRUE(asleep(one) && asleep(two));
  (void)world.set_loop(loop, true);
  ASSERT_TRUE(world.step(kStep).ok());
  EXPECT_FALSE(asleep(one) || asleep(two));
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(world.step(kStep).ok());
    EXPECT_FALSE(world.loop_gap(loop) > 0.01 && asleep(one)) << "while the rope was pulled in";
  }
  EXPECT_LT((world.prop_pose(two).translation - world.prop_pose(one).translation).norm(), 2.6f);
  (void)world.set_loop(loop, false);
  for (int n = 0; n < 1200 && !(asleep(one) && asleep(two)); ++n) ASSERT_TRUE(world.step(kStep).ok());
  EXPECT_TRUE(asleep(one) && asleep(two));
}

TEST(Ties, WhatIsTiedTogetherStaysTogetherBeyondTheLimitOfAnIsland) {
  constexpr int kBalls = 6;
  WorldSettings settings;
  settings.island_dofs = 3 * 6;
  settings.ground = false;
  World<float> world(settings);
  for (int n = 0; n < kBalls; ++n) add_ball(world, {double(n), 0, 5});
  for (int n = 1; n < kBalls; ++n) add_rope(world, n - 1, n, 1, LoopKind::kDistance);
  (void)world.set_prop(0, world.prop_pose(0), {0, 0, 6}, Vec3<float>::Zero());
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(world.step(kStep).ok());
  for (int n = 0; n + 1 < kBalls; ++n) EXPECT_LT(world.loop_gap(n), 5e-3) << "rod " << n;
}

TEST(Ties, ParkedCharacterStaysOutOfTheWorldInASnapshot) {
  World<float> world({});
  Status status;
  ASSERT_EQ(world.add_character(humanoid(), {}, status), 0);
  (void)world.park_character(0);
  std::vector<std::byte> bytes(world.snapshot_capacity());
  bytes.resize(world.save(bytes));
  (void)world.unpark_character(0);
  ASSERT_TRUE(world.restore(bytes).ok());
  EXPECT_TRUE(world.parked(0));
}

}  // namespace
}  // namespace sinew
