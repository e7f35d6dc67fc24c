// What muscles have left, against figures worked out by hand.
#include "sinew/character/spare_acceleration.h"

#include "character/rods.h"
#include "character/scenes.h"

namespace sinew {
namespace {

/// A fixed root and a rod of 2 kg and 1 m that a hinge with 30 N m holds level: 9.81 N m of load.
TEST(SpareAcceleration, OfALevelRodIsWhatItsHingeHasLeftOverItsInertia) {
  const Skeleton skeleton = fixtures::rods(1);
  WorldSettings settings;
  settings.ground = false;
  World<double> world(settings);
  Status status;
  ASSERT_EQ(world.add_character(skeleton, {}, status), 0) << status.reason;
  std::vector<JointJet<double>> still(2);
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(world.character(0).set_target(still).ok());
    if (k == 0) (void)world.character(0).reset();
    ASSERT_TRUE(world.step(1 / 60.0).ok());
  }
  std::vector<double> spare(2);
  spare_acceleration<double>(world.character(0), spare);
  EXPECT_EQ(spare[0], 1e6) << "no muscle moves the root";
  const double inertia = 2.0 / 12 + 2 * 0.25;  // about the hinge; half of the trace is a millionth more
  EXPECT_NEAR(spare[1], (30 - 9.81) / inertia, 1e-3 * 30);
}

TEST(SpareAcceleration, OfATiredFigureIsLess) {
  const Skeleton skeleton = fixtures::humanoid();
  const auto least = [&](double strength) {
    World<float> world({});
    Status status;
    CharacterSettings settings;
    settings.strength = strength;
    EXPECT_EQ(world.add_character(skeleton, settings, status), 0);
    std::vector<float> spare(skeleton.joints.size());
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(world.character(0).set_target(fixtures::idle<float>(skeleton, k / 60.0)).ok());
      if (k == 0) (void)world.character(0).reset();
      EXPECT_TRUE(world.step(1 / 60.f).ok());
    }
    spare_acceleration<float>(world.character(0), spare);
    return *std::min_element(spare.begin(), spare.end());
  };
  EXPECT_GT(least(1), 10);
  EXPECT_LT(least(0.5), 0.6f * least(1));
  EXPECT_GE(least(0.01), 0);
}

}  // namespace
}  // namespace sinew
