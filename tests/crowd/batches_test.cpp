// A world that checks animations in batches against one that does not: nobody can tell, but by the clock.
#include <cstring>

#include "character/scenes.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"

namespace sinew {
namespace {

constexpr float kStep = 1 / 60.f;

/// Limits and damping on every joint, for rows of every kind.
Skeleton with_limits(Skeleton s) {
  for (Joint& joint : s.joints) {
    if (joint.type == JointType::kBall) {
      joint.swing_limit = 1;
      joint.swing_axis = -Vec3<double>::UnitZ();
      joint.twist_lower = -0.7;
      joint.twist_upper = 0.7;
    } else if (joint.type == JointType::kRevolute) {
      joint.dofs[0].lower = -0.3;
      joint.dofs[0].upper = 2;
      joint.dofs[0].damping = 0.5;
    }
  }
  return s;
}

WorldSettings settings_of(bool batches, int workers) {
  WorldSettings settings;
  settings.batches = batches;
  settings.workers = workers;
  return settings;
}

void expect_same(World<float>& a, World<float>& b, int frame) {
  std::vector<std::byte> one(a.snapshot_capacity()), two(b.snapshot_capacity());
  one.resize(a.save(one));
  two.resize(b.save(two));
  ASSERT_EQ(one, two) << "frame " << frame;
  for (int n = 0; n < a.character_count(); ++n) {
    const CharacterReport &x = a.character(n).report(), &y = b.character(n).report();
    ASSERT_EQ(x.outer_passes, y.outer_passes) << n;
    ASSERT_EQ(x.factorisations, y.factorisations) << n;
    ASSERT_EQ(x.simplified_steps, y.simplified_steps) << n;
    ASSERT_EQ(x.converged, y.converged) << n;
    ASSERT_EQ(x.kinetic_energy, y.kinetic_energy) << n;
    ASSERT_EQ(x.elastic_energy, y.elastic_energy) << n;
  }
}

/// Bodies on their animation, of two rigs, some above a floor that does not bear them, whose strengths differ
/// by so much that what the weakest are asked for overcomes them now and then.
struct Played {
  Skeleton rigs[2] = {fixtures::humanoid(), with_limits(fixtures::humanoid())};
  World<float> world;
  int count, frame = 0;

  Played(bool batches, int characters, int workers = 1)
      : world(settings_of(batches, workers)), count(characters) {
    Status status;
    for (int n = 0; n < count; ++n) {
      CharacterSettings how;
      how.ground_contact = n % 5 != 4;
      how.strength = std::pow(10., -(n % 8) / 4.);
      EXPECT_EQ(world.add_character(rigs[n % 3 == 2], how, status), n) << status.reason;
    }
    aim();
    for (int n = 0; n < count; ++n) (void)world.character(n).reset();
  }
  void aim() {
    for (int n = 0; n < count; ++n) {
      std::vector<JointJet<float>> jets = fixtures::idle<float>(rigs[0], 0.1 * n + frame * double(kStep));
      jets[0].translation.x() += 5 * float(n);
      ASSERT_TRUE(world.character(n).set_target(jets).ok());
    }
  }
  void step(const ParallelFor& parallel_for = {}) {
    ++frame;
    aim();
    if (frame % 4 == 0) {  // the push of one is no reason to check the others otherwise
      Character<float> c = world.character(frame % count);
      ASSERT_TRUE(c.apply_impulse(3, c.model()[3].translation, {0.1f, 0, 0}).ok());
    }
    ASSERT_TRUE(world.step(kStep, parallel_for).ok());
  }
};

TEST(Batches, AnimationsAreCheckedToTheBitAsAlone) {
  constexpr int kCount = 90;
  Played batched(true, kCount), alone(false, kCount), three(true, kCount, 3);
  int threads = 3, played = 0, overcome = 0;
  for (int n = 0; n < 40; ++n) {
    batched.step();
    alone.step();
    three.step({fixtures::run_on_threads, &threads});
    for (int i = 0; i < kCount; ++i) {
      const auto torque = alone.world.character(i).torque();
      for (Played* other : {&batched, &three}) {
        const auto same = other->world.character(i).torque();
        ASSERT_TRUE(std::equal(torque.begin(), torque.end(), same.begin())) << i << ", frame " << n;
      }
      ++(alone.world.character(i).report().unknown_dofs == 0 ? played : overcome);
    }
    expect_same(batched.world, alone.world, n);
    expect_same(batched.world, three.world, n);
  }
  EXPECT_GT(played, 1000);
  EXPECT_GT(overcome, 100);
}

TEST(Batches, NothingIsAllocated) {
  Played played(true, 40);
  for (int n = 0; n < 5; ++n) ASSERT_TRUE(played.world.step(kStep).ok());
  const auto before = fixtures::allocations.load();
  for (int n = 0; n < 20; ++n) ASSERT_TRUE(played.world.step(kStep).ok());
  EXPECT_EQ(fixtures::allocations.load(), before);
}

}  // namespace
}  // namespace sinew
