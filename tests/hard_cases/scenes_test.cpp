// Ordinary situations, as `sinew study scenes --quick` judges them. What is known to fail must: whoever mends
// one takes it off the list.
#include <gtest/gtest.h>

#include <ostream>

#include "fixtures/known_failure.h"
#include "study/scenes/situation.h"

namespace sinew::study {

void PrintTo(const Situation& situation, std::ostream* out) {
  *out << situation.name << ": " << situation.about;
}

namespace {

class Situations : public testing::TestWithParam<Situation> {};

TEST_P(Situations, PassOrAreKnownToFail) {
  const Situation& situation = GetParam();
  const SituationResult result = run_situation(situation, true);
  ASSERT_EQ(result.findings.refused(), "");
  if (const char* why = known_to_fail(situation.name)) {
    EXPECT_FALSE(result.findings.passed()) << "passes: take it off the list";
    if (!HasFailure()) GTEST_SKIP() << "known to fail: " << why;
    return;
  }
  EXPECT_TRUE(result.findings.passed()) << situation_table(result);
}

// Taut planks turn against what pulls them: a matrix without that took 180 passes a step, and did not
// converge.
TEST(HangingBridge, TakesFewPasses) {
  scene::Scene bridge;
  ASSERT_FALSE(scene::load_scene(situation_file({"hanging_bridge", "", nullptr}), bridge));
  bridge.frame_rate = 30;
  const Played played(bridge);
  ASSERT_EQ(played.refused, "");
  int passes = 0;
  for (const scene::TelemetryRow& row : played.telemetry.rows) passes += row.report.outer_passes;
  EXPECT_LE(passes, 15 * static_cast<int>(played.telemetry.rows.size()));
}

INSTANTIATE_TEST_SUITE_P(All, Situations, testing::ValuesIn(situations()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sinew::study
