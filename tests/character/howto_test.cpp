// The code blocks of the character layer's README, as they stand there.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "character/scenes.h"
#include "sinew/character/contact_events.h"
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

}  // namespace
}  // namespace sinew
