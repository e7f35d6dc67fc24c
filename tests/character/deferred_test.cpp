// A played step leaves to whoever asks: loads, joint speeds, history, totals. When it is asked changes no
// bit.
#include "character/scenes.h"

namespace sinew {
namespace {

/// A humanoid that plays, is pushed, fades, falls, recovers, and is set down elsewhere by its clip.
template <class T>
struct Scene {
  Skeleton skeleton = fixtures::humanoid();
  World<T> world{{}};
  int frame = 0;

  explicit Scene(int check_every) {
    Status status;
    CharacterSettings settings;
    settings.detail.check_every = check_every;
    EXPECT_EQ(world.add_character(skeleton, settings, status), 0) << status.reason;
    EXPECT_TRUE(hero().set_target(fixtures::idle<T>(skeleton, 0)).ok());
    (void)hero().reset();
  }
  Character<T> hero() { return world.character(0); }
  void step() {
    ++frame;
    std::vector<JointJet<T>> target = fixtures::idle<T>(skeleton, frame / 60.0);
    if (frame >= 200) target[0].translation.x() += T(3);
    EXPECT_TRUE(hero().set_target(target).ok());
    const int chest = skeleton.find("chest"), arm = skeleton.find("upperarm_l");
    if (frame > 10 && frame < 20) {
      EXPECT_TRUE(hero().set_strength(arm, T(20 - frame) / 10).ok());
    }
    if (frame == 30) {
      EXPECT_TRUE(hero().apply_impulse(chest, hero().model()[chest].translation, {T(30), T(20), T(0)}).ok());
    }
    if (frame == 120) {
      (void)hero().set_root_drive(RootDrive::kFree);
      EXPECT_TRUE(hero().set_strength(T(0.02)).ok());
    }
    if (frame == 150) {
      (void)hero().set_root_drive(RootDrive::kKinematic);
      EXPECT_TRUE(hero().set_strength(T(1)).ok());
    }
    ASSERT_TRUE(world.step(T(1) / 60).ok());
  }
  std::vector<std::byte> saved() {
    std::vector<std::byte> bytes(world.snapshot_capacity());
    bytes.resize(world.save(bytes));
    return bytes;
  }
  /// Everything that is worked out when asked for.
  std::vector<double> answers() {
    const CharacterReport& r = hero().report();
    std::vector<double> all{r.kinetic_energy, r.potential_energy};
    for (const Vec3<double>& v : {r.momentum, r.angular_momentum}) all.insert(all.end(), v.begin(), v.end());
    all.insert(all.end(), hero().load().begin(), hero().load().end());
    all.insert(all.end(), hero().limit().begin(), hero().limit().end());
    return all;
  }
};

template <class T>
class Deferred : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Deferred, Scalars);

TYPED_TEST(Deferred, AskingAfterEveryStepOrNeverEndsInTheSameBits) {
  for (const int check_every : {1, 3}) {
    // Fading; before, at and after the push; on the way back; falling; recovered; before and after the leap.
    for (const int end : {15, 29, 30, 31, 40, 121, 149, 199, 200, 203}) {
      Scene<TypeParam> asked(check_every), unasked(check_every);
      while (asked.frame < end) {
        asked.step();
        (void)asked.answers();
        (void)asked.saved();
        unasked.step();
      }
      EXPECT_EQ(unasked.answers(), asked.answers()) << check_every << ", " << end;
      EXPECT_EQ(unasked.saved(), asked.saved()) << check_every << ", " << end;
    }
  }
}

TYPED_TEST(Deferred, LateAnswersAreThoseOfTheLastStep) {
  Scene<TypeParam> early(1), late(1);
  early.step();
  late.step();
  const std::vector<double> answers = early.answers();
  EXPECT_GT(answers[0], 0);  // it moves
  EXPECT_TRUE(late.hero().set_target(fixtures::idle<TypeParam>(late.skeleton, 1)).ok());
  EXPECT_EQ(late.answers(), answers) << "after a new target";

  Scene<TypeParam> weak(1), back(1);
  weak.step();
  back.step();
  EXPECT_TRUE(weak.hero().set_strength(TypeParam(0.5)).ok());
  EXPECT_EQ(weak.answers(), answers) << "after the muscles changed";
  (void)back.hero().reset();
  EXPECT_EQ(back.answers(), answers) << "after a reset";
}

}  // namespace
}  // namespace sinew
