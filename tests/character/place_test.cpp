// Where a character stands: far from the world's origin, and moved there from one frame to the next.
#include <gtest/gtest.h>

#include "character/scenes.h"

namespace sinew {
namespace {

using fixtures::humanoid;

/// A limp figure thrown onto a box whose top is 1 m up, `away` metres from the origin along x and y.
struct Fall {
  Skeleton skeleton = humanoid();
  World<float> world{WorldSettings{}};

  explicit Fall(double away) {
    Collider box;
    box.shape = Shape::kBox;
    box.size = {3, 3, 0.5};
    box.local.translation = {away, away, 0.5};
    EXPECT_TRUE(world.add_obstacle(box).ok());
    CharacterSettings limp;
    limp.root = RootDrive::kFree;
    limp.strength = 0;
    Status status;
    EXPECT_EQ(world.add_character(skeleton, limp, status), 0) << status.reason;
    std::vector<JointJet<float>> jets = fixtures::idle<float>(skeleton, 0);
    jets[0].translation += Vec3<float>(float(away), float(away), 1.1f);
    jets[0].omega = {0.f, 2.f, 0.f};
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    (void)world.character(0).reset();
  }
};

TEST(FarAway, FloatFallsOntoABoxAsAtTheOrigin) {
  constexpr double away = 65536;  // m
  Fall here(0), there(away);
  int touching = 0;
  for (int n = 0; n < 40; ++n) {
    ASSERT_TRUE(here.world.step(1 / 60.f).ok());
    ASSERT_TRUE(there.world.step(1 / 60.f).ok());
    touching += there.world.character(0).report().contacts > 0;
    // Beyond the first contacts, rounding grows as in any fall; until then it is float's 1e-7 of a metre a
    // step.
    const Vec3<double> offset(away, away, 0);
    EXPECT_LT((there.world.character(0).position() - offset - here.world.character(0).position()).norm(),
              1e-3)
        << "step " << n;
  }
  EXPECT_GT(touching, 5);
}

TEST(FarAway, PoseIsThePositionRounded) {
  Fall there(65536);
  for (int n = 0; n < 10; ++n) ASSERT_TRUE(there.world.step(1 / 60.f).ok());
  const Character<float> figure = there.world.character(0);
  EXPECT_EQ(figure.position().cast<float>(), figure.local()[0].translation);
  EXPECT_EQ(figure.model()[0].translation, figure.local()[0].translation);
}

/// A figure on its animation with one limp arm that swings.
struct Swinging {
  Skeleton skeleton = humanoid();
  World<double> world{WorldSettings{}};
  int arm = skeleton.find("upperarm_l");

  Swinging() {
    Status status;
    EXPECT_EQ(world.add_character(skeleton, {}, status), 0) << status.reason;
    EXPECT_TRUE(world.character(0).set_strength(arm, 0.0).ok());
    EXPECT_TRUE(world.character(0)
                    .apply_impulse(arm, world.character(0).model()[arm] * Vec3<double>(0, 0, -0.2),
                                   Vec3<double>(3, 0, 0))
                    .ok());
    for (int n = 0; n < 20; ++n) EXPECT_TRUE(world.step(1 / 60.0).ok());
  }
  void put(const Vec3<double>& to, double yaw) {
    std::vector<JointJet<double>> jets = fixtures::idle<double>(skeleton, 0);
    jets[0].translation += to;
    jets[0].rotation = Eigen::AngleAxisd(yaw, Vec3<double>::UnitZ()) * jets[0].rotation;
    ASSERT_TRUE(world.character(0).set_target(jets).ok());
    ASSERT_TRUE(world.step(1 / 60.0).ok());
  }
};

TEST(Teleport, LimpArmSwingsOnAsIfTheRootHadStoodThereAllAlong) {
  Swinging stayed, moved;
  stayed.put(Vec3<double>::Zero(), 0);
  moved.put({1000, -20, 3}, 2);
  EXPECT_FALSE(stayed.world.character(0).report().carried);
  EXPECT_TRUE(moved.world.character(0).report().carried);
  for (int n = 0; n < 60; ++n) {
    ASSERT_TRUE(stayed.world.step(1 / 60.0).ok());
    ASSERT_TRUE(moved.world.step(1 / 60.0).ok());
    const Quat<double> a = stayed.world.character(0).local()[stayed.arm].rotation,
                       b = moved.world.character(0).local()[moved.arm].rotation;
    // Gravity is along the axis that the figure was turned about, so that nothing but rounding differs; what
    // a solve at tolerance leaves adds up.
    EXPECT_LT(a.angularDistance(b), 1e-3) << "step " << n;
  }
  EXPECT_FALSE(moved.world.character(0).report().carried);
}

TEST(Teleport, FreeRootIsNotMovedByItsTarget) {
  Swinging figure;
  (void)figure.world.character(0).set_root_drive(RootDrive::kFree);
  const Vec3<double> before = figure.world.character(0).position();
  figure.put({1000, 0, 0}, 0);
  EXPECT_FALSE(figure.world.character(0).report().carried);
  EXPECT_LT((figure.world.character(0).position() - before).norm(), 0.2);
}

}  // namespace
}  // namespace sinew
