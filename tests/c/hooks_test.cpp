// What a host hears of the library through the C interface: refused calls, and its own context.
#include <string>
#include <vector>

#include "c/scene.h"

namespace sinew {
namespace {

struct Heard {
  sinew_log_level level;
  std::string words;
  int index;
};

void keep(void* context, sinew_log_level level, const char* words, std::int32_t index) {
  static_cast<std::vector<Heard>*>(context)->push_back({level, words, index});
}

TEST(CHooks, EveryRefusedCallIsHeardOf) {
  std::vector<Heard> heard;
  ASSERT_EQ(sinew_set_log(keep, &heard), SINEW_OK);
  sinew_asset asset = 0;
  EXPECT_EQ(sinew_asset_load("/no/such/file.sinew", &asset), SINEW_IO);
  EXPECT_EQ(sinew_world_step(0, 0.01f), SINEW_BAD_HANDLE);
  const fixtures::CScene scene;
  const sinew_play beyond{scene.hero, scene.asset, 99, 0, 0, 1, 0};
  EXPECT_EQ(sinew_play_clips(&beyond, 1), SINEW_INVALID_ARGUMENT);
  ASSERT_EQ(heard.size(), 3u);
  EXPECT_EQ(heard[0].words, "file cannot be opened");
  EXPECT_EQ(heard[1].words, "the handle is 0, which names nothing");
  EXPECT_EQ(heard[2].words, sinew_last_reason());
  EXPECT_EQ(heard[2].index, 99) << "the clip";
  EXPECT_EQ(sinew_last_index(), 0) << "which of the plays";
  for (const Heard& h : heard) EXPECT_EQ(h.level, SINEW_LOG_ERROR);
  ASSERT_EQ(sinew_set_log(nullptr, nullptr), SINEW_OK);
  EXPECT_EQ(sinew_world_step(0, 0.01f), SINEW_BAD_HANDLE);
  EXPECT_EQ(heard.size(), 3u);
}

TEST(CHooks, WhatIsNotBuiltInIsRefusedWithTheOptionThatAsksForIt) {
  const auto ignore = [](void*, const char*) {};
  const sinew_status profiler = sinew_set_profiler(ignore, ignore, nullptr);
  if (profiler != SINEW_OK) {
    EXPECT_EQ(profiler, SINEW_UNSUPPORTED);
    EXPECT_STREQ(sinew_last_reason(), "built without SINEW_PROFILER");
  } else {
    EXPECT_EQ(sinew_set_profiler(ignore, nullptr, nullptr), SINEW_INVALID_ARGUMENT);
    EXPECT_EQ(sinew_set_profiler(nullptr, nullptr, nullptr), SINEW_OK);
  }
  const sinew_status assertion = sinew_set_assertion(nullptr, nullptr);
  if (assertion != SINEW_OK) {
    EXPECT_EQ(assertion, SINEW_UNSUPPORTED);
    EXPECT_STREQ(sinew_last_reason(), "built without SINEW_ASSERTS");
  }
}

}  // namespace
}  // namespace sinew
