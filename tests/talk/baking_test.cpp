// "Wrists and ankles are dynamic ¼ of the time, and kinematic with q'' = -q'*kd the rest of the time", where
// a world asks for it.
#include <gtest/gtest.h>

#include "scene/humanoid.h"
#include "sinew/character/world.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

/// rad, that a limp hand of a standing figure turns against its arm in each step; it begins with 2 rad/s.
std::vector<double> turns_of_hand(double decay, bool bake, int steps) {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.detail.baked_decay = decay;
  World<double> world(settings);
  const Skeleton skeleton = scene::humanoid();
  const int hand = skeleton.find("hand_r");
  Status status;
  Character<double> figure = world.character(world.add_character(skeleton, {}, status));
  EXPECT_TRUE(status) << status.reason;
  std::vector<JointJet<double>> jets(skeleton.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = skeleton.joints[i].rest.rotation;
    jets[i].translation = skeleton.joints[i].rest.translation;
  }
  std::vector<JointJet<double>> start = jets;
  start[hand].omega = {0, 2, 0};
  EXPECT_TRUE(figure.set_target(start));
  (void)figure.reset();
  EXPECT_TRUE(figure.set_target(jets));
  EXPECT_TRUE(figure.set_strength(hand, 0));
  CharacterDetail detail;
  detail.bake = bake;
  EXPECT_TRUE(figure.set_detail(detail));
  std::vector<double> turns;
  for (int n = 0; n < steps; ++n) {
    const Quat<double> before = figure.local()[hand].rotation;
    EXPECT_TRUE(world.step(kStep));
    turns.push_back(before.angularDistance(figure.local()[hand].rotation));
  }
  return turns;
}

TEST(BakedAsInTheTalk, ThreeStepsOfFourSlowByTheDecay) {
  constexpr double decay = 12, kept = 1 / (1 + decay * kStep);  // by implicit Euler
  const std::vector<double> turns = turns_of_hand(decay, true, 12);
  EXPECT_NEAR(turns[0], 2 * kStep * kept, 1e-9);
  for (std::size_t n = 0; n + 2 < turns.size();
       n += 4) {  // a fourth step is solved for, and slows by friction
    EXPECT_NEAR(turns[n + 1] / turns[n], kept, 1e-6) << "step " << n + 1;
    EXPECT_NEAR(turns[n + 2] / turns[n + 1], kept, 1e-6) << "step " << n + 2;
    EXPECT_GT(std::abs(turns[n + 3] / turns[n + 2] - kept), 1e-3) << "step " << n + 3;
  }
}

TEST(BakedAsInTheTalk, IsNotWhatHappensWithoutBeingAskedFor) {
  EXPECT_EQ(turns_of_hand(12, false, 8), turns_of_hand(0, false, 8)) << "who does not bake";
  const std::vector<double> own = turns_of_hand(0, true, 8), dynamic = turns_of_hand(0, false, 8);
  for (std::size_t n = 0; n < own.size(); ++n) EXPECT_NEAR(own[n], dynamic[n], 1e-3) << "rad, step " << n;
}

}  // namespace
}  // namespace sinew
