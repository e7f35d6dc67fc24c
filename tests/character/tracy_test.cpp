// The sample's adapter to Tracy, with a stand-in for Tracy: zones that nest, too deep ones, other threads.
#include "hooks/tracy.h"

#include <gtest/gtest.h>

#include <thread>

namespace {

const sinew::Profiler zones = tracy_zones();

TEST(Tracy, ZonesNestAndHaveTheirNames) {
  told.clear();
  zones.begin(zones.context, "step");
  zones.begin(zones.context, "solve");
  zones.end(zones.context, "solve");
  zones.begin(zones.context, "report");
  zones.end(zones.context, "report");
  zones.end(zones.context, "step");
  EXPECT_EQ(told, (std::vector<std::string>{"begin step", "begin solve", "end solve", "begin report",
                                            "end report", "end step"}));
}

TEST(Tracy, WhatIsTooDeepIsLeftOutAndEndsNobodyElse) {
  told.clear();
  for (int n = 0; n < 40; ++n) zones.begin(zones.context, "deep");
  for (int n = 0; n < 40; ++n) zones.end(zones.context, "deep");
  EXPECT_EQ(told.size(), 64u);
  zones.end(zones.context, "never begun");
  EXPECT_EQ(told.size(), 64u);
  zones.begin(zones.context, "step");
  zones.end(zones.context, "step");
  EXPECT_EQ(told.back(), "end step");
}

TEST(Tracy, EveryThreadHasItsOwn) {
  told.clear();
  zones.begin(zones.context, "outer");
  std::thread([] { zones.end(zones.context, "another's"); }).join();
  EXPECT_EQ(told, (std::vector<std::string>{"begin outer"}));
  zones.end(zones.context, "outer");
  EXPECT_EQ(told.back(), "end outer");
}

}  // namespace
