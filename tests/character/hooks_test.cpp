// What a host hears of a step: what it could not do, how its parts nest, and assumptions that do not hold.
#include "sinew/skeleton/hooks.h"

#include <string>
#include <vector>

#include "character/scenes.h"

namespace sinew {
namespace {

struct Heard {
  LogLevel level;
  std::string words;
  int index;
};

class Hooks : public ::testing::Test {
 protected:
  void SetUp() override {
    set_log({[](void* context, LogLevel level, const char* words, int index) {
               static_cast<std::vector<Heard>*>(context)->push_back({level, words, index});
             },
             &heard_});
  }
  void TearDown() override {
    set_log({});
    (void)set_profiler({});
    (void)set_assert({});
  }
  std::vector<Heard> heard_;
};

/// Two balls, one on the other, in a world that solves so many degrees of freedom together.
void stack_balls(World<float>& world) {
  for (const double z : {0.1, 0.299}) {
    PropSettings ball;
    ball.pose.translation.z() = z;
    Status status;
    ASSERT_GE(world.add_prop(ball, status), 0) << status.reason;
  }
}

TEST_F(Hooks, StepsTellWhatTheyCouldNotDoOfWhom) {
  WorldSettings narrow;
  narrow.island_dofs = 6;
  World<float> world(narrow);
  stack_balls(world);
  ASSERT_TRUE(world.step(1 / 60.f));
  ASSERT_TRUE(world.prop_report(0).crowded || world.prop_report(1).crowded);
  ASSERT_FALSE(heard_.empty());
  EXPECT_EQ(heard_[0].level, LogLevel::kWarning);
  EXPECT_EQ(heard_[0].words, "a prop may pass through another: more touch than island_dofs allows");
  EXPECT_TRUE(world.prop_report(heard_[0].index).crowded);
}

TEST_F(Hooks, AStepThatDoesAllIsSilent) {
  World<float> world({});
  stack_balls(world);
  for (int n = 0; n < 30; ++n) ASSERT_TRUE(world.step(1 / 60.f));
  EXPECT_TRUE(heard_.empty());
}

TEST_F(Hooks, PartsOfAStepNest) {
  struct Zones {
    std::vector<std::string> open, seen;
    bool nested = true;
  } zones;
  const Status set = set_profiler({[](void* context, const char* zone) {
                                     auto& z = *static_cast<Zones*>(context);
                                     z.open.emplace_back(zone);
                                     z.seen.emplace_back(zone);
                                   },
                                   [](void* context, const char* zone) {
                                     auto& z = *static_cast<Zones*>(context);
                                     z.nested = z.nested && !z.open.empty() && z.open.back() == zone;
                                     if (!z.open.empty()) z.open.pop_back();
                                   },
                                   &zones});
  if (!set) GTEST_SKIP() << set.reason;
  World<float> world({});
  stack_balls(world);
  ASSERT_TRUE(world.step(1 / 60.f));
  EXPECT_TRUE(zones.nested);
  EXPECT_TRUE(zones.open.empty());
  ASSERT_FALSE(zones.seen.empty());
  EXPECT_EQ(zones.seen.front(), "step");
  for (const char* part : {"who touches", "island", "contacts", "solve", "factorise", "velocities"})
    EXPECT_NE(std::find(zones.seen.begin(), zones.seen.end(), part), zones.seen.end()) << part;
}

TEST_F(Hooks, AnAssumptionThatDoesNotHoldIsToldWithItsPlace) {
  struct Failure {
    std::string condition, file;
    int count = 0;
  } failure;
  const Status set = set_assert({[](void* context, const char* condition, const char* file, int line) {
                                   auto& f = *static_cast<Failure*>(context);
                                   f = {condition, file, f.count + (line > 0)};
                                 },
                                 &failure});
  if (!set) GTEST_SKIP() << set.reason;
  [[maybe_unused]] const int two = 2;
  SINEW_ASSERT(two == 2);
  EXPECT_EQ(failure.count, 0);
  SINEW_ASSERT(two == 3);
  EXPECT_EQ(failure.count, 1);
  EXPECT_EQ(failure.condition, "two == 3");
  EXPECT_NE(failure.file.find("hooks_test.cpp"), std::string::npos);
}

}  // namespace
}  // namespace sinew
