// The code blocks of the character layer's README, as they stand there.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "character/scenes.h"
#include "sinew/character/contact_events.h"
#include "sinew/character/debug_draw.h"
#include "sinew/character/queries.h"
#include "sinew/character/sensor.h"
#include "sinew/effects/wind.h"

namespace sinew {
namespace {

using fixtures::Playing;

/// What the blocks log.
struct Log {
  std::vector<std::string> lines;
  void operator()(const char* line) { lines.emplace_back(line); }
};

TEST(Readme, NamesOfNothingAreRefusedWithTheReasonsThatItGives) {
  Playing<float> scene;
  World<float>& world = scene.world;
  const Skeleton broken;
  Log log;
#include "names.inc"
  ASSERT_EQ(log.lines.size(), 3u);
  EXPECT_EQ(log.lines[1], "no such character");
  EXPECT_EQ(log.lines[2], "the gust is over");
}

TEST(Readme, BallThatFallsIsHeard) {
  World<float> world({});
  Status added;
  PropSettings ball;
  ball.pose.translation = {0, 0, 1};
  ASSERT_EQ(world.add_prop(ball, added), 0) << added.reason;
  Log log;
#include "contacts.inc"
  EXPECT_TRUE(status.ok()) << status.reason;
  EXPECT_EQ(log.lines, std::vector<std::string>{"thud"});
}

TEST(Readme, LookFindsTheCrateAndThereIsNoRoomBesideIt) {
  World<float> world({});
  Collider crate;
  crate.shape = Shape::kBox;
  crate.size = {0.5, 0.5, 0.5};
  crate.local.translation = {4, 0, 0.5};
  ASSERT_TRUE(world.add_obstacle(crate).ok());
  const int hero = -1;
  const Vec3<double> eye(0, 0, 0.7), look(1, 0, 0), feet(3.2, 0, 0);
  Log log;
#include "queries.inc"
  EXPECT_TRUE(status.ok()) << status.reason;
  EXPECT_EQ(log.lines, (std::vector<std::string>{"a crate in sight", "no room to stand"}));
}

TEST(Readme, DoorTellsOfWhoStandsThere) {
  Playing<float> scene;
  World<float>& world = scene.world;
  Log log;
#include "sensors.inc"
  EXPECT_TRUE(status.ok()) << status.reason;
  EXPECT_EQ(log.lines, std::vector<std::string>{"somebody is at the door"});
}

TEST(Readme, ViewShowsBonesAndSaysWhatTheStepDid) {
  Playing<float> scene;
  scene.step();
  World<float>& world = scene.world;
  Log log;
#include "debug_draw.inc"
  EXPECT_GE(view.lines, static_cast<int>(scene.skeleton.joints.size()) - 1);
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0].rfind("character 0: on its animation", 0), 0u) << log.lines[0];
}

}  // namespace
}  // namespace sinew
