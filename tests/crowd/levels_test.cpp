// Levels of detail: what they save, that they are not seen, and that a budget keeps to its limit.
#include <cmath>
#include <numbers>

#include "character/scenes.h"
#include "fixtures/known_failure.h"
#include "fixtures/threads.h"

namespace sinew {
namespace {

using fixtures::humanoid;
using fixtures::idle;

constexpr float kStep = 1 / 60.f;
constexpr double kDegree = std::numbers::pi / 180;

CharacterSettings passive() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

/// A limp figure that lies on the floor, asleep.
struct Sleeper {
  WorldSettings settings;
  World<float> world;

  static WorldSettings sleepy() {
    WorldSettings settings;
    settings.detail.sleep_after = 0.5;
    return settings;
  }
  explicit Sleeper(const Skeleton& skeleton = humanoid()) : settings(sleepy()), world(settings) {
    Status status;
    EXPECT_EQ(world.add_character(skeleton, passive(), status), 0) << status.reason;
    world.character(0).reset();
    for (int n = 0; n < 1200 && level() != Level::kAsleep; ++n) EXPECT_TRUE(world.step(kStep).ok());
    EXPECT_EQ(level(), Level::kAsleep) << "never came to rest";
  }
  Level level() { return world.character(0).report().level; }
  std::vector<Transform<float>> pose() {
    const auto model = world.character(0).model();
    return {model.begin(), model.end()};
  }
};

TEST(Sleep, WhoLiesAtRestCostsNothingAndStaysWhereItIs) {
  Sleeper scene;
  const auto before = scene.pose();
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(scene.world.step(kStep).ok());
  EXPECT_EQ(scene.level(), Level::kAsleep);
  EXPECT_EQ(scene.world.report().cost, 0);
  EXPECT_EQ(scene.world.character(0).report().kinetic_energy, 0);
  EXPECT_EQ(scene.pose(), before);
}

TEST(Sleep, NobodySleepsUnlessAsked) {
  World<float> world({});
  Status status;
  ASSERT_EQ(world.add_character(humanoid(), passive(), status), 0);
  for (int n = 0; n < 600; ++n) ASSERT_TRUE(world.step(kStep).ok());
  EXPECT_NE(world.character(0).report().level, Level::kAsleep);
}

TEST(Sleep, PushWakesInTheSameStep) {
  Sleeper scene;
  const auto before = scene.pose();
  ASSERT_TRUE(scene.world.character(0).apply_impulse(0, before[0].translation, {20, 0, 5}).ok());
  ASSERT_TRUE(scene.world.step(kStep).ok());
  EXPECT_GT(scene.level(), Level::kChecked);
  EXPECT_GT((scene.pose()[0].translation - before[0].translation).norm(), 1e-3f);
}

TEST(Sleep, StrengthAndDriveWakeButATargetIsNoUseToTheLimp) {
  Sleeper scene;
  ASSERT_TRUE(scene.world.character(0).set_target(idle<float>(scene.world.character(0).skeleton(), 1)).ok());
  ASSERT_TRUE(scene.world.step(kStep).ok());
  EXPECT_EQ(scene.level(), Level::kAsleep);
  ASSERT_TRUE(scene.world.character(0).set_strength(0.5f).ok());
  ASSERT_TRUE(scene.world.step(kStep).ok());
  EXPECT_NE(scene.level(), Level::kAsleep);
}

TEST(Sleep, StrengthOfAMuscleWakes) {
  Skeleton skeleton = humanoid();
  skeleton.muscles.push_back({"grip", "", skeleton.find("hand_r"), 0, 5, 5});
  Sleeper scene(skeleton);
  ASSERT_TRUE(scene.world.character(0).set_muscle_strength(0, 0.5f).ok());
  ASSERT_TRUE(scene.world.step(kStep).ok());
  EXPECT_NE(scene.level(), Level::kAsleep);
}

TEST(Sleep, TouchWakesPassingByDoesNot) {
  for (const bool touches : {false, true}) {
    Sleeper scene;
    const Vec3<float> at = scene.pose()[0].translation;
    PropSettings ball;
    ball.mass = 4;
    ball.pose.translation = {double(at.x()) - 4, double(at.y()) + (touches ? 0 : 2.2), double(at.z()) + 0.1};
    ball.velocity = {6, 0, 1.5};
    Status status;
    ASSERT_EQ(scene.world.add_prop(ball, status), 0) << status.reason;
    bool woke = false;
    for (int n = 0; n < 50; ++n) {
      ASSERT_TRUE(scene.world.step(kStep).ok());
      woke = woke || scene.level() != Level::kAsleep;
    }
    EXPECT_EQ(woke, touches);
  }
}

TEST(Sleep, BoxesOfAStackSleepTogetherAndTheUpperOneWakesWhenTheLowerIsTaken) {
  World<float> world(Sleeper::sleepy());
  Status status;
  for (int n = 0; n < 2; ++n) {
    PropSettings box;
    box.shape = Shape::kBox;
    box.size = {0.2, 0.2, 0.1};
    box.pose.translation = {0, 0, 0.1 + 0.2 * n};
    ASSERT_EQ(world.add_prop(box, status), n) << status.reason;
  }
  for (int n = 0; n < 120; ++n) ASSERT_TRUE(world.step(kStep).ok());
  EXPECT_EQ(world.prop_report(0).level, Level::kAsleep);
  EXPECT_EQ(world.prop_report(1).level, Level::kAsleep);
  world.park_prop(0);
  for (int n = 0; n < 30; ++n) ASSERT_TRUE(world.step(kStep).ok());
  EXPECT_LT(world.prop_pose(1).translation.z(), 0.15f) << "hangs in the air";
}

TEST(Sleep, SnapshotOfASleeperGoesOnToTheBit) {
  Sleeper one, two;
  std::vector<std::byte> bytes(one.world.snapshot_capacity());
  bytes.resize(one.world.save(bytes));
  ASSERT_TRUE(two.world.character(0).apply_impulse(0, {0, 0, 0}, {3, 0, 0}).ok());
  ASSERT_TRUE(two.world.step(kStep).ok());
  ASSERT_TRUE(two.world.restore(bytes).ok());
  for (Sleeper* scene : {&one, &two}) {
    ASSERT_TRUE(scene->world.step(kStep).ok());
    EXPECT_EQ(scene->level(), Level::kAsleep);
    ASSERT_TRUE(scene->world.character(0).apply_impulse(2, scene->pose()[2].translation, {0, 9, 3}).ok());
    for (int n = 0; n < 20; ++n) ASSERT_TRUE(scene->world.step(kStep).ok());
  }
  EXPECT_EQ(one.pose(), two.pose());
}

TEST(Detail, RefusesWhatCannotBeMeant) {
  fixtures::Playing<float> scene;
  CharacterDetail detail;
  detail.significance = std::nan("");
  EXPECT_EQ(scene.character().set_detail(detail).code, Code::kNotFinite);
  detail = {};
  detail.check_every = 0;
  EXPECT_EQ(scene.character().set_detail(detail).code, Code::kOutOfRange);
}

TEST(Detail, FarCharactersAreCheckedNowAndThenAndPlayTheClipBitForBit) {
  fixtures::Playing<float> near, far;
  CharacterDetail detail;
  detail.check_every = 8;
  ASSERT_TRUE(far.character().set_detail(detail).ok());
  double cost_near = 0, cost_far = 0;
  for (int n = 0; n < 64; ++n) {
    near.step();
    far.step();
    ASSERT_TRUE(far.pose_is_the_targets_bits()) << n;
    EXPECT_EQ(far.character().report().level, Level::kChecked);
    cost_near += near.world.report().cost;
    cost_far += far.world.report().cost;
  }
  EXPECT_LT(cost_far, 0.55 * cost_near);
  const int hand = far.skeleton.find("hand_r");
  for (auto* scene : {&near, &far}) {
    const Vec3<float> at = scene->character().model()[hand].translation;
    ASSERT_TRUE(scene->character().apply_impulse(hand, at, {15, 0, 0}).ok());
    scene->step();
    EXPECT_EQ(scene->character().report().level, Level::kSubsteps) << "up at once";  // the hand is flung
  }
  // Both were solved from the same state: the far one's history was made up for.
  for (std::size_t i = 0; i < near.skeleton.joints.size(); ++i)
    EXPECT_LT(near.character().local()[i].rotation.angularDistance(far.character().local()[i].rotation),
              1e-3f)
        << i;
}

TEST(Detail, LevelIsKeptForTheDwellTimeAndNoLonger) {
  fixtures::Playing<float> scene;
  for (int n = 0; n < 5; ++n) scene.step();
  const int hand = scene.skeleton.find("hand_r");
  ASSERT_TRUE(
      scene.character().apply_impulse(hand, scene.character().model()[hand].translation, {15, 0, 0}).ok());
  int solved = 0, high = 0;
  for (int n = 0; n < 240; ++n) {
    scene.step();
    solved = scene.character().report().unknown_dofs > 0 ? n + 1 : solved;
    high = scene.character().report().level > Level::kChecked ? n + 1 : high;
  }
  EXPECT_GT(solved, 0);
  EXPECT_NEAR(high - solved, 60, 1) << "one second";
}

/// The largest angle between two characters' joints (rad).
double apart(const Character<float>& a, const Character<float>& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.local().size(); ++i)
    most = std::max(most, a.local()[i].rotation.angularDistance(b.local()[i].rotation));
  return double(most);
}

TEST(Detail, CapOnADisturbedCharacterIsNotSeen) {
  // Whenever the cap comes, the first step under it differs from one without by less than the promise: 0.5°,
  // and 5 % of the speed of the fastest joint (or of a slow 1 rad/s).
  int followed = 0;
  for (int when = 2; when < 60; when += 2) {
    fixtures::Playing<float> capped, free;
    fixtures::Playing<float>* both[] = {&capped, &free};
    const int hand = free.skeleton.find("hand_r");
    for (auto* scene : both) {
      for (int n = 0; n < 5; ++n) scene->step();
      const Vec3<float> at = scene->character().model()[hand].translation;
      ASSERT_TRUE(scene->character().apply_impulse(hand, at, {15, 0, 0}).ok());
      for (int n = 0; n < when; ++n) scene->step();
    }
    std::vector<Transform<float>> before(free.character().local().begin(), free.character().local().end());
    CharacterDetail detail;
    detail.most = Level::kPlayback;
    ASSERT_TRUE(capped.character().set_detail(detail).ok());
    for (auto* scene : both) scene->step();
    double fastest = 1;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const float turned = before[i].rotation.angularDistance(free.character().local()[i].rotation);
      fastest = std::max(fastest, double(turned / kStep));
    }
    followed += capped.character().report().level == Level::kPlayback;
    if (capped.character().report().level != Level::kPlayback) continue;  // still thrown: solved as before
    const double jump = apart(capped.character(), free.character());
    EXPECT_LT(jump, 0.5 * kDegree) << when;
    EXPECT_LT(jump / double(kStep), 0.05 * fastest) << when;
  }
  EXPECT_GT(followed, 5);
}

TEST(Detail, CapOnADisturbedCharacterComesOffUnseen) {
  fixtures::Playing<float> raised, capped;
  fixtures::Playing<float>* both[] = {&raised, &capped};
  const int hand = raised.skeleton.find("hand_r");
  CharacterDetail detail;
  for (auto* scene : both) {
    const Vec3<float> at = scene->character().model()[hand].translation;
    ASSERT_TRUE(scene->character().apply_impulse(hand, at, {6, 0, 0}).ok());
    detail.most = Level::kSubsteps;
    ASSERT_TRUE(scene->character().set_detail(detail).ok());
    scene->step();
    detail.most = Level::kPlayback;
    ASSERT_TRUE(scene->character().set_detail(detail).ok());
    for (int n = 0; n < 40 && scene->character().report().level != Level::kPlayback; ++n) scene->step();
    ASSERT_EQ(scene->character().report().level, Level::kPlayback);
    ASSERT_FALSE(scene->character().on_animation());
  }
  ASSERT_TRUE(raised.character().set_detail({}).ok());
  for (auto* scene : both) scene->step();
  EXPECT_GT(raised.character().report().level, Level::kPlayback);
  EXPECT_LT(apart(raised.character(), capped.character()), 0.5 * kDegree);
}

TEST(Detail, BakedHandsAreDynamicLessOftenAndTheRestOfTheBodyHardlyKnows) {
  fixtures::Playing<float> free, baked;
  fixtures::Playing<float>* both[] = {&free, &baked};
  CharacterDetail detail;
  detail.bake = true;
  ASSERT_TRUE(baked.character().set_detail(detail).ok());
  const int hand = free.skeleton.find("hand_r"), dof = free.character().first_dof(hand);
  const int arm = free.skeleton.find("upperarm_r");
  for (auto* scene : both) ASSERT_TRUE(scene->character().set_strength(hand, 0.1f).ok());
  int dynamic_free = 0, dynamic_baked = 0;
  double sum = 0, terms = 0;
  for (int n = 0; n < 60; ++n) {
    for (auto* scene : both) {
      if (n % 20 == 0) {
        const Vec3<float> at = scene->character().model()[arm + 1].translation;  // the elbow
        ASSERT_TRUE(scene->character().apply_impulse(arm, at, {25, 8, 0}).ok());
      }
      scene->step();
    }
    dynamic_free += free.character().unknown()[dof];
    dynamic_baked += baked.character().unknown()[dof];
    for (std::size_t i = 0; i < free.skeleton.joints.size(); ++i) {
      if (int(i) == hand) continue;
      ++terms;
      const double angle =
          double(free.character().model()[i].rotation.angularDistance(baked.character().model()[i].rotation));
      sum += angle * angle;
    }
  }
  EXPECT_GT(dynamic_free, 8);
  EXPECT_GT(dynamic_baked, 0);
  EXPECT_LT(dynamic_baked, dynamic_free);
  const double off = std::sqrt(sum / terms);
  // A quarter of the steps, and those in which it was struck; the criterion of the catalogue's case 54.
  SINEW_FAILS_TODAY(dynamic_baked <= 15 + 3 && off < 3 * kDegree,
                    "hits act at once, and the arm whirls: 31 steps of the unbaked one's 46, 3.07 degrees");
}

/// A grid of characters that idle, of which one in ten is pushed every second.
struct Plaza {
  Skeleton skeleton = humanoid();
  World<float> world;
  int count, frame = 0;
  std::mt19937 random{3};
  std::vector<std::vector<Level>> levels;  ///< [frame][character]

  Plaza(const WorldSettings& settings, int characters) : world(settings), count(characters) {
    Status status;
    for (int n = 0; n < count; ++n) {
      CharacterSettings character;
      character.detail.significance = n;
      EXPECT_EQ(world.add_character(skeleton, character, status), n) << status.reason;
      aim(n);
      world.character(n).reset();
    }
  }
  void aim(int n) {
    auto jets = idle<float>(skeleton, frame / 60.0 + n);
    const int row = n / 20;
    jets[0].translation += Vec3<float>(3.f * float(row), 3.f * float(n % 20), 0);
    EXPECT_TRUE(world.character(n).set_target(jets).ok());
  }
  /// Only the first `active` ones are in the world.
  void show(int active) {
    for (int n = 0; n < count; ++n)
      if (n < active && world.parked(n)) {
        aim(n);
        world.unpark_character(n);
      } else if (n >= active && !world.parked(n)) {
        world.park_character(n);
      }
  }
  void step(int active, const ParallelFor& parallel_for = {}) {
    ++frame;
    for (int n = 0; n < active; ++n) aim(n);
    const double share = active / 600.0;
    int pushes = static_cast<int>(std::floor(share * frame) - std::floor(share * (frame - 1)));
    while (pushes-- > 0) {
      Character<float> c = world.character(static_cast<int>(random() % static_cast<unsigned>(active)));
      const int hand = skeleton.find("hand_r");
      EXPECT_TRUE(c.apply_impulse(hand, c.model()[hand].translation, {18, 4, 0}).ok());
    }
    EXPECT_TRUE(world.step(kStep, parallel_for).ok());
    levels.emplace_back();
    for (int n = 0; n < active; ++n) levels.back().push_back(world.character(n).report().level);
  }
  /// Of the steps from `begin` on.
  double mean_cost(int active, int begin, int end) {
    double sum = 0;
    for (int n = 0; n < end; ++n) {
      step(active);
      if (n >= begin) sum += world.report().cost / (end - begin);
    }
    return sum;
  }
};

constexpr int kFew = 40, kMany = 4 * kFew;

/// Units of work for a quarter of the plaza, and a fifth more.
double usual_limit() {
  Plaza plaza({}, kFew);
  return 1.2 * plaza.mean_cost(kFew, 60, 180);
}

TEST(Budget, FourfoldLoadReturnsUnderTheLimitWithinThirtyFrames) {
  WorldSettings settings;
  settings.detail.budget.limit = usual_limit();
  Plaza plaza(settings, kMany);
  plaza.show(kFew);
  for (int n = 0; n < 120; ++n) plaza.step(kFew);
  EXPECT_EQ(plaza.world.report().capped, 0) << "there was room for these";
  plaza.show(kMany);
  const double limit = settings.detail.budget.limit;
  double worst = 0, unlimited = 0;  // means over half a second
  for (int half = 0; half < 6; ++half) {
    double mean = 0;
    for (int n = 0; n < 30; ++n) {
      plaza.step(kMany);
      mean += plaza.world.report().cost / 30;
      if (half == 0 && n == 1) unlimited = plaza.world.report().cost;
    }
    if (half > 0) worst = std::max(worst, mean);
  }
  EXPECT_GT(unlimited, 2.5 * limit);
  EXPECT_GT(plaza.world.report().capped, 0);
  // The least significant gave way.
  EXPECT_EQ(plaza.world.character(0).report().level, Level::kPlayback);
  EXPECT_GE(plaza.world.character(kMany - 1).report().level, Level::kChecked);
  // And get their due again when there is room.
  plaza.show(kFew / 2);
  for (int n = 0; n < 240; ++n) plaza.step(kFew / 2);
  EXPECT_EQ(plaza.world.report().capped, 0);
  // From thirty frames after the load came.
  EXPECT_LT(worst, limit);
}

TEST(Budget, NobodyGoesUpAndDownMoreThanOnceASecondUnderASteadyLoad) {
  WorldSettings settings;
  settings.detail.budget.limit = usual_limit();
  Plaza plaza(settings, kMany);
  for (int n = 0; n < 600; ++n) plaza.step(kMany);
  int most = 0;
  for (int c = 0; c < kMany; ++c) {
    std::vector<int> falls;  // a fall and the rise before it: one time up and down
    for (int n = 121; n < 600; ++n)
      if (plaza.levels[n][c] < plaza.levels[n - 1][c]) falls.push_back(n);
    for (std::size_t k = 0; k < falls.size(); ++k) {
      int within = 0;
      for (std::size_t l = k; l < falls.size() && falls[l] - falls[k] < 60; ++l)
        within +=
            l == k || std::any_of(plaza.levels.begin() + falls[l - 1], plaza.levels.begin() + falls[l],
                                  [&](const auto& now) { return now[c] > plaza.levels[falls[l - 1]][c]; });
      most = std::max(most, within);
    }
  }
  EXPECT_LE(most, 1);
}

TEST(Budget, CountedInWorkGivesTheSameBitsOnAnyNumberOfThreads) {
  WorldSettings settings;
  settings.detail.budget.limit = usual_limit();
  std::vector<std::byte> wanted;
  for (int threads : {1, 3}) {
    settings.workers = threads;
    Plaza plaza(settings, kMany);
    for (int n = 0; n < 90; ++n) plaza.step(kMany, {fixtures::run_on_threads, &threads});
    EXPECT_GT(plaza.world.report().capped, 0);
    std::vector<std::byte> bytes(plaza.world.snapshot_capacity());
    bytes.resize(plaza.world.save(bytes));
    if (wanted.empty()) wanted = bytes;
    EXPECT_EQ(bytes, wanted);
  }
}

/// A clock that runs as fast as work is done by a processor of this test's making: 3 µs per call.
double ticking(void* context) {
  return *static_cast<double*>(context) += 3;
}

TEST(Budget, GoesByTheHostsClockWhereThereIsOne) {
  double now = 0;
  WorldSettings settings;
  settings.detail.budget = {1e9, ticking, &now};
  settings.batches = false;  // which are measured as a whole, and shared out
  Plaza plaza(settings, kFew);
  plaza.step(kFew);
  EXPECT_NEAR(plaza.world.report().cost, 3 * kFew, 1e-6) << "one reading before an island and one after";
}

}  // namespace
}  // namespace sinew
