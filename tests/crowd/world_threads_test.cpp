// A world's step on the host's threads: the same bits for any number of them, and nothing from the heap.
#include <cstring>

#include "character/scenes.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"

namespace sinew {
namespace {

constexpr float kStep = 1 / 60.f;

/// Twelve characters that idle, four limp ones that fall in pairs onto each other, and balls that are thrown
/// at some.
struct Scene {
  Skeleton skeleton = fixtures::humanoid();
  World<float> world;
  std::vector<JointJet<float>> jets;
  int characters = 16, frame = 0;

  explicit Scene(const WorldSettings& settings) : world(settings) {
    Status status;
    for (int n = 0; n < characters; ++n) {
      CharacterSettings character;
      if (n >= 12) {
        character.root = RootDrive::kFree;
        character.strength = 0;
      }
      EXPECT_EQ(world.add_character(skeleton, character, status), n) << status.reason;
      aim(n);
      (void)world.character(n).reset();
    }
    for (int n = 0; n < 3; ++n) {
      PropSettings ball;
      ball.pose.translation = {-1.0, 4.0 * n, 1.3};
      ball.velocity = {12, 0, 0};
      ball.mass = 2;
      EXPECT_EQ(world.add_prop(ball, status), n) << status.reason;
    }
  }
  /// Limp ones in pairs, so near that they fall onto each other; the rest in a row.
  void aim(int n) {
    jets = fixtures::idle<float>(skeleton, frame / 60.0 + n);
    const int pair = n / 2;
    jets[0].translation += n < 12 ? Vec3<float>(0, 2.f * float(n), 0)
                                  : Vec3<float>(8.f + 0.8f * float(n % 2), 5.f * float(pair), 0.4f);
    EXPECT_TRUE(world.character(n).set_target(jets).ok());
  }
  void step(const ParallelFor& parallel_for) {
    ++frame;
    for (int n = 0; n < 12; ++n) aim(n);
    if (frame % 10 == 3)
      for (const int pushed : {frame % 12, (frame + 5) % 12}) {
        Character<float> c = world.character(pushed);
        EXPECT_TRUE(c.apply_impulse(4, c.model()[4].translation, {20, 5, 0}).ok());
      }
    ASSERT_TRUE(world.step(kStep, parallel_for).ok());
  }
  std::vector<std::byte> snapshot() const {
    std::vector<std::byte> bytes(world.snapshot_capacity());
    bytes.resize(world.save(bytes));
    return bytes;
  }
};

/// What the world holds after each of 40 steps.
std::vector<std::vector<std::byte>> run(int workers, const ParallelFor& parallel_for) {
  WorldSettings settings;
  settings.workers = workers;
  Scene scene(settings);
  std::vector<std::vector<std::byte>> states;
  int most_unknown = 0;
  for (int n = 0; n < 40; ++n) {
    scene.step(parallel_for);
    states.push_back(scene.snapshot());
    int unknown = 0;
    for (int c = 0; c < 12; ++c) unknown += scene.world.character(c).report().unknown_dofs > 0;
    most_unknown = std::max(most_unknown, unknown);
  }
  EXPECT_GE(most_unknown, 2) << "the scene was to have several islands to solve";
  return states;
}

TEST(WorldThreads, AnyNumberOfThreadsAndAnyOrderGiveTheSameBits) {
  const auto alone = run(1, {});
  for (int threads : {1, 2, 4, 7}) {
    const auto together = run(threads, {fixtures::run_on_threads, &threads});
    for (std::size_t n = 0; n < alone.size(); ++n)
      ASSERT_EQ(together[n], alone[n]) << threads << " threads, step " << n;
  }
  fixtures::Shuffled shuffled;
  const auto in_disorder = run(5, shuffled.parallel_for());
  for (std::size_t n = 0; n < alone.size(); ++n) ASSERT_EQ(in_disorder[n], alone[n]) << "step " << n;
}

TEST(WorldThreads, MoreWorkersThanTheHostRunsAtOnceAreServedInTurn) {
  int one = 1;
  EXPECT_EQ(run(4, {fixtures::run_on_threads, &one}), run(4, {}));
}

TEST(WorldThreads, StepAllocatesNothing) {
  WorldSettings settings;
  settings.workers = 4;
  Scene scene(settings);
  fixtures::Shuffled shuffled;
  std::vector<std::vector<std::vector<JointJet<float>>>> targets(60);
  for (int n = 0; n < 60; ++n)
    for (int c = 0; c < 12; ++c) {
      targets[n].push_back(fixtures::idle<float>(scene.skeleton, n / 60.0 + c));
      targets[n].back()[0].translation.y() += 2.f * float(c);
    }
  const long before = fixtures::allocations;
  for (int n = 0; n < 60; ++n) {
    for (int c = 0; c < 12; ++c) (void)scene.world.character(c).set_target(targets[n][c]);
    (void)scene.world.step(kStep, shuffled.parallel_for());
  }
  EXPECT_EQ(fixtures::allocations - before, 0);
}

TEST(WorldThreads, AnIslandBeyondTheLimitIsCutAndSaysSo) {
  WorldSettings settings;
  settings.island_dofs = 2 * 37;
  World<float> world(settings);
  Status status;
  const Skeleton skeleton = fixtures::humanoid();
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  for (int n = 0; n < 3; ++n) {
    ASSERT_EQ(world.add_character(skeleton, limp, status), n);
    std::vector<JointJet<float>> jets = fixtures::idle<float>(skeleton, 0);
    jets[0].translation += Vec3<float>(0.5f * float(n), 0, 0);
    ASSERT_TRUE(world.character(n).set_target(jets).ok());
    (void)world.character(n).reset();
  }
  bool crowded = false;
  for (int n = 0; n < 90; ++n) {  // until they fall upon each other
    ASSERT_TRUE(world.step(kStep).ok());
    crowded = crowded || world.character(2).report().crowded;
  }
  EXPECT_TRUE(crowded);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(world.character(n).model()[0].translation.allFinite());
}

}  // namespace
}  // namespace sinew
