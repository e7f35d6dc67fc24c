// Who passes through whom: by layers, and pair by pair.
#include <gtest/gtest.h>

#include "character/scenes.h"
#include "sinew/character/world.h"

namespace sinew {
namespace {

using fixtures::Playing;

constexpr BodyRef kLower{BodyKind::kProp, 0, 0}, kUpper{BodyKind::kProp, 1, 0};

/// A ball falls onto one that lies on the floor, exactly above it.
template <class T>
struct TwoBalls {
  World<T> world;

  TwoBalls(std::uint32_t lower_meets, std::uint32_t upper_meets, const WorldSettings& settings = {})
      : world(settings) {
    Status status;
    PropSettings ball;  // of 0.1 m
    ball.pose.translation.z() = 0.1;
    ball.layers = 2;
    ball.meets = lower_meets;
    EXPECT_EQ(world.add_prop(ball, status), 0) << status.reason;
    ball.pose.translation.z() = 0.5;
    ball.layers = 4;
    ball.meets = upper_meets;
    EXPECT_EQ(world.add_prop(ball, status), 1) << status.reason;
  }
  double height(int ball) const { return double(world.prop_pose(ball).translation.z()); }
  void run(int frames) {
    for (int n = 0; n < frames; ++n) ASSERT_TRUE(world.step(T(1) / T(60)));
  }
};

using Scalars = ::testing::Types<float, double>;
template <class T>
struct Meets : ::testing::Test {};
TYPED_TEST_SUITE(Meets, Scalars);

TYPED_TEST(Meets, EitherSideIsEnoughToPassThroughAndTheFloorDoesNotAsk) {
  constexpr std::uint32_t kAll = ~0u;
  TwoBalls<TypeParam> both(kAll, kAll), lower_not(kAll & ~4u, kAll), upper_not(kAll, kAll & ~2u),
      nobody(0, 0);
  for (auto* scene : {&both, &lower_not, &upper_not, &nobody}) scene->run(60);
  EXPECT_NEAR(both.height(1), 0.3, 0.01) << "on top of the other";
  for (auto* scene : {&lower_not, &upper_not, &nobody})
    for (const int ball : {0, 1})
      EXPECT_NEAR(scene->height(ball), 0.1, 0.002) << "on the floor, in each other";
}

TYPED_TEST(Meets, WhoPassesThroughHasTheBitsThatItHasAlone) {
  TwoBalls<TypeParam> apart(0, 0);
  World<TypeParam> alone{WorldSettings{}};
  Status status;
  PropSettings ball;
  ball.pose.translation.z() = 0.5;
  ASSERT_EQ(alone.add_prop(ball, status), 0) << status.reason;
  for (int n = 0; n < 60; ++n) {
    apart.run(1);
    ASSERT_TRUE(alone.step(TypeParam(1) / TypeParam(60)));
    ASSERT_EQ(apart.world.prop_pose(1).translation, alone.prop_pose(0).translation) << n;
  }
}

TYPED_TEST(Meets, PairsArePutApartAndTogetherAgain) {
  TwoBalls<TypeParam> scene(~0u, ~0u);
  ASSERT_TRUE(scene.world.keep_apart(kUpper, kLower));
  scene.run(40);
  EXPECT_NEAR(scene.height(1), 0.1, 0.002);
  Transform<TypeParam> above;
  above.translation = {0, 0, TypeParam(0.5)};
  ASSERT_TRUE(scene.world.set_prop(1, above, Vec3<TypeParam>::Zero(), Vec3<TypeParam>::Zero()));
  ASSERT_TRUE(scene.world.keep_apart(kLower, kUpper, false));
  scene.run(60);
  EXPECT_NEAR(scene.height(1), 0.3, 0.01);
}

TEST(MeetsPairs, SleepersWakeWhenWhatBearsThemIsKeptApart) {
  WorldSettings settings;
  settings.detail.sleep_after = 0.2;
  TwoBalls<float> scene(~0u, ~0u, settings);
  scene.run(240);
  ASSERT_EQ(scene.world.prop_report(1).level, Level::kAsleep);
  ASSERT_TRUE(scene.world.keep_apart(kLower, kUpper));
  scene.run(60);
  EXPECT_NEAR(scene.height(1), 0.1, 0.002);
}

TEST(MeetsPairs, WhoPlaysIsPassedThroughWithoutANotice) {
  for (const bool by_layer : {true, false}) {
    Playing<float> hit, calm;
    PropSettings ball;
    ball.mass = 5;
    ball.pose.translation = {2, 0, 1};
    ball.velocity = {-8, 0, 0};
    if (by_layer) ball.meets = 0;
    Status status;
    ASSERT_EQ(hit.world.add_prop(ball, status), 0) << status.reason;
    if (!by_layer) {
      ASSERT_TRUE(hit.world.keep_apart({BodyKind::kCharacter, 0, 0}, {BodyKind::kProp, 0, 0}));
    }
    for (int n = 0; n < 30; ++n) {
      hit.step();
      calm.step();
      ASSERT_EQ(hit.world.character(0).report().unknown_dofs, calm.world.character(0).report().unknown_dofs);
      for (std::size_t j = 0; j < hit.skeleton.joints.size(); ++j)
        ASSERT_EQ(hit.world.character(0).model()[j].translation,
                  calm.world.character(0).model()[j].translation);
    }
    EXPECT_LT(hit.world.prop_pose(0).translation.x(), -1.5f) << "it went through";
  }
}

TEST(MeetsPairs, NamesOfNothingAreRefused) {
  TwoBalls<float> scene(~0u, ~0u);
  EXPECT_EQ(scene.world.keep_apart(kLower, {BodyKind::kProp, 2, 0}).code, Code::kInvalidArgument);
  EXPECT_EQ(scene.world.keep_apart({BodyKind::kCharacter, 0, 0}, kLower).code, Code::kInvalidArgument);
  EXPECT_EQ(scene.world.keep_apart({BodyKind::kGround, 0, 0}, kLower).code, Code::kInvalidArgument);
  EXPECT_EQ(scene.world.keep_apart(kLower, kLower).code, Code::kInvalidArgument);
}

}  // namespace
}  // namespace sinew
