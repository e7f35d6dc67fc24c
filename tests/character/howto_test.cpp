// The code blocks of the character layer's README, as they stand there.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "character/scenes.h"
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

}  // namespace
}  // namespace sinew
