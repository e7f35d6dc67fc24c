// A world that solves in batches against one that does not: nobody can tell, but by the clock.
#include <cstring>
#include <random>

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

struct Thrown {
  World<float> world;
  int count;

  Thrown(bool batches, const Skeleton& rig, int characters, double strength, int workers = 1,
         double height = 100)
      : world(settings(batches, workers)), count(characters) {
    Status status;
    for (int n = 0; n < count; ++n) {
      CharacterSettings how;
      how.root = RootDrive::kFree;
      how.strength = strength;
      EXPECT_EQ(world.add_character(rig, how, status), n) << status.reason;
      std::mt19937 random(unsigned(n) + 1);
      std::normal_distribution<float> normal;
      std::vector<JointJet<float>> jets(rig.joints.size());
      for (std::size_t i = 0; i < jets.size(); ++i) {
        jets[i].rotation = rig.joints[i].rest.rotation.cast<float>();
        jets[i].translation = rig.joints[i].rest.translation.cast<float>();
        jets[i].omega = {normal(random), normal(random), normal(random)};
      }
      jets[0].translation += Vec3<float>(5 * float(n), 0, float(height));
      EXPECT_TRUE(world.character(n).set_target(jets).ok());
      world.character(n).reset();
    }
  }
  static WorldSettings settings(bool batches, int workers) {
    WorldSettings settings;
    settings.batches = batches;
    settings.workers = workers;
    return settings;
  }
  /// A hit on some of them.
  void push(int frame) {
    for (int n = frame % 7; n < count; n += 7) {
      Character<float> c = world.character(n);
      const int joint = (frame + n) % 14;
      ASSERT_TRUE(c.apply_impulse(joint, c.model()[joint].translation, {5, float(n % 3), -2}).ok());
    }
  }
};

void expect_same(World<float>& a, World<float>& b, int frame) {
  std::vector<std::byte> one(a.snapshot_capacity()), two(b.snapshot_capacity());
  one.resize(a.save(one));
  two.resize(b.save(two));
  ASSERT_EQ(one, two) << "frame " << frame;
  for (int n = 0; n < a.character_count(); ++n) {
    const CharacterReport &x = a.character(n).report(), &y = b.character(n).report();
    ASSERT_EQ(x.outer_passes, y.outer_passes) << n;
    ASSERT_EQ(x.factorisations, y.factorisations) << n;
    ASSERT_EQ(x.chords, y.chords) << n;
    ASSERT_EQ(x.converged, y.converged) << n;
    ASSERT_EQ(x.kinetic_energy, y.kinetic_energy) << n;
    ASSERT_EQ(x.elastic_energy, y.elastic_energy) << n;
  }
}

TEST(Batches, LimpBodiesInFlightMoveToTheBitAsAlone) {
  Thrown batched(true, with_limits(fixtures::humanoid()), 20, 0),
      alone(false, with_limits(fixtures::humanoid()), 20, 0);
  ASSERT_GT(batched.world.memory().solving, alone.world.memory().solving) << "there are batches";
  for (int n = 0; n < 60; ++n) {
    ASSERT_TRUE(batched.world.step(kStep).ok());
    ASSERT_TRUE(alone.world.step(kStep).ok());
    expect_same(batched.world, alone.world, n);
  }
}

TEST(Batches, SoDoWeakOnesThatAreHit) {
  Thrown batched(true, with_limits(fixtures::humanoid()), 20, 0.02),
      alone(false, with_limits(fixtures::humanoid()), 20, 0.02);
  for (int n = 0; n < 60; ++n) {
    for (Thrown* t : {&batched, &alone}) {
      t->push(n);
      ASSERT_TRUE(t->world.step(kStep).ok());
    }
    expect_same(batched.world, alone.world, n);
  }
}

TEST(Batches, SoDoThoseThatReachTheGroundWhileOthersFly) {
  Thrown batched(true, fixtures::humanoid(), 12, 0, 1, 1), alone(false, fixtures::humanoid(), 12, 0, 1, 1);
  for (int n = 0; n < 60; ++n) {
    for (Thrown* t : {&batched, &alone}) {
      if (n < 40) t->push(n);
      ASSERT_TRUE(t->world.step(kStep).ok());
    }
    expect_same(batched.world, alone.world, n);
  }
}

TEST(Batches, ThreadsShareThemOutAsTheyLike) {
  Thrown one(true, fixtures::humanoid(), 40, 0), three(true, fixtures::humanoid(), 40, 0, 3);
  int threads = 3;
  for (int n = 0; n < 20; ++n) {
    ASSERT_TRUE(one.world.step(kStep).ok());
    ASSERT_TRUE(three.world.step(kStep, {fixtures::run_on_threads, &threads}).ok());
    expect_same(one.world, three.world, n);
  }
}

TEST(Batches, RigsAreNotMixed) {
  const Skeleton rigs[] = {fixtures::humanoid(), with_limits(fixtures::humanoid())};
  World<float> worlds[] = {World<float>(Thrown::settings(true, 1)), World<float>(Thrown::settings(false, 1))};
  for (World<float>& world : worlds) {
    Status status;
    for (int n = 0; n < 16; ++n) {
      CharacterSettings how;
      how.root = RootDrive::kFree;
      how.strength = 0;
      ASSERT_EQ(world.add_character(rigs[n % 2], how, status), n);
      std::vector<JointJet<float>> jets(rigs[0].joints.size());
      for (std::size_t i = 0; i < jets.size(); ++i)
        jets[i].translation = rigs[0].joints[i].rest.translation.cast<float>();
      jets[0].translation += Vec3<float>(5 * float(n), 0, 100);
      jets[3].omega = {float(n), 1, 2};
      ASSERT_TRUE(world.character(n).set_target(jets).ok());
      world.character(n).reset();
    }
  }
  for (int n = 0; n < 30; ++n) {
    for (World<float>& world : worlds) ASSERT_TRUE(world.step(kStep).ok());
    expect_same(worlds[0], worlds[1], n);
  }
}

/// Bodies on their animation of which some limbs hang limp: `groups` different choices of limbs among them.
struct Hanging {
  Skeleton rig = fixtures::humanoid();
  World<float> world;
  int count, frame = 0;

  Hanging(bool batches, int characters, int groups, int workers = 1)
      : world(Thrown::settings(batches, workers)), count(characters) {
    Status status;
    for (int n = 0; n < count; ++n) {
      EXPECT_EQ(world.add_character(rig, {}, status), n) << status.reason;
      std::mt19937 random(unsigned(n % groups) + 1);
      for (int joint = 1; joint < rig.body_count; ++joint)
        if (random() % 8 == 0 || joint == 1 + n % groups % 13) {
          EXPECT_TRUE(world.character(n).set_strength(joint, 0).ok());
        }
    }
    aim();
    for (int n = 0; n < count; ++n) world.character(n).reset();
  }
  void aim() {
    for (int n = 0; n < count; ++n) {
      std::vector<JointJet<float>> jets = fixtures::idle<float>(rig, 0.1 * n + frame * double(kStep));
      jets[0].translation.x() += 5 * float(n);
      ASSERT_TRUE(world.character(n).set_target(jets).ok());
    }
  }
  void step(const ParallelFor& parallel_for = {}) {
    ++frame;
    aim();
    ASSERT_TRUE(world.step(kStep, parallel_for).ok());
  }
};

TEST(Batches, LimpLimbsOfPlayedBodiesMoveToTheBitAsAlone) {
  for (const int groups : {1, 3, 80}) {  // all alike; enough of each for a batch; more than may wait
    Hanging batched(true, 80, groups), alone(false, 80, groups), three(true, 80, groups, 3);
    int threads = 3, partly = 0;
    for (int n = 0; n < 15; ++n) {
      batched.step();
      alone.step();
      three.step({fixtures::run_on_threads, &threads});
      expect_same(batched.world, alone.world, n);
      expect_same(batched.world, three.world, n);
    }
    for (int n = 0; n < 80; ++n) {
      const int unknowns = batched.world.character(n).report().unknown_dofs;
      partly += unknowns > 0 && unknowns < 0.75 * 37;
    }
    EXPECT_GT(partly, 70) << groups << " groups: few are so free that batches mix them";
  }
}

/// Bodies on their animation, of two rigs, some above a floor that does not bear them, whose strengths differ
/// by so much that what the weakest are asked for overcomes them now and then.
struct Played {
  Skeleton rigs[2] = {fixtures::humanoid(), with_limits(fixtures::humanoid())};
  World<float> world;
  int count, frame = 0;

  Played(bool batches, int characters, int workers = 1)
      : world(Thrown::settings(batches, workers)), count(characters) {
    Status status;
    for (int n = 0; n < count; ++n) {
      CharacterSettings how;
      how.ground_contact = n % 5 != 4;
      how.strength = std::pow(10., -(n % 8) / 4.);
      EXPECT_EQ(world.add_character(rigs[n % 3 == 2], how, status), n) << status.reason;
    }
    aim();
    for (int n = 0; n < count; ++n) world.character(n).reset();
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
  Thrown thrown(true, with_limits(fixtures::humanoid()), 20, 0);
  Played played(true, 40);
  for (World<float>* world : {&thrown.world, &played.world}) {
    for (int n = 0; n < 5; ++n) ASSERT_TRUE(world->step(kStep).ok());
    const auto before = fixtures::allocations.load();
    for (int n = 0; n < 20; ++n) ASSERT_TRUE(world->step(kStep).ok());
    EXPECT_EQ(fixtures::allocations.load(), before);
  }
}

}  // namespace
}  // namespace sinew
