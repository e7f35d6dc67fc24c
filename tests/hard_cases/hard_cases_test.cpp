// Every case of the catalogue passes, or is on the one list of known failures and still fails; the same for
// what its steps may cost, counted in passes. Times are judged by the study only.
#include <gtest/gtest.h>

#include <set>

#include "study/study.h"

namespace sinew::study {

void PrintTo(const HardCase& c, std::ostream* out) {
  *out << c.name << ": " << c.criterion;
}

namespace {

/// A set of its own: cases that take long run in their own tests (random trees, soak).
std::vector<HardCase> tested() {
  std::vector<HardCase> cases = hard_cases();
  std::erase_if(cases, [](const HardCase& c) {
    return std::string(c.name) == "soak_hour" || std::string(c.name) == "random_trees";
  });
  return cases;
}

class Catalogue : public testing::TestWithParam<HardCase> {};

TEST_P(Catalogue, PassesOrIsKnownToFail) {
  const StabilityResult result = run_case(GetParam(), true);
  const char* known = known_failure(GetParam().name);
  const char* exceeds = known_excess(GetParam().name);
  EXPECT_EQ(result.excess.empty(), exceeds == nullptr)
      << result.excess << "; tools/study/known_failures.cpp says "
      << (exceeds ? exceeds : "that it does not exceed");
  if (known && !result.passed) GTEST_SKIP() << "known failure: " << known << "; today: " << result.reason;
  EXPECT_FALSE(known) << "passes now: take it off the list in tools/study/known_failures.cpp";
  EXPECT_TRUE(result.passed) << result.reason;
}

INSTANTIATE_TEST_SUITE_P(HardCases, Catalogue, testing::ValuesIn(tested()),
                         [](const testing::TestParamInfo<HardCase>& of) { return of.param.name; });

TEST(Catalogue, NamesAreUniqueAndCasesSayWhatTheyAskAndWhere) {
  std::set<std::string> names;
  for (const HardCase& c : hard_cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_NE(std::string(c.criterion), "") << c.name;
    EXPECT_NE(std::string(c.source), "") << c.name;
    const bool runs = c.in_float || c.in_double;
    EXPECT_EQ(runs, std::string(c.unsupported).empty()) << c.name;
    EXPECT_EQ(runs, !c.steps.empty()) << c.name;
  }
}

TEST(Catalogue, HoldsEveryRowOfTheResearchPage) {
  std::set<std::string> rows;
  for (const HardCase& c : hard_cases()) rows.insert(c.row);
  for (int row = 1; row <= 66; ++row) EXPECT_TRUE(rows.count(std::to_string(row))) << "row " << row;
}

TEST(Catalogue, ListsWhatIsNotSupportedAsKnownToFail) {
  for (const HardCase& c : hard_cases()) EXPECT_TRUE(!*c.unsupported || known_failure(c.name)) << c.name;
}

TEST(Catalogue, CountsPassedAndFailedInItsJson) {
  std::vector<StabilityResult> results(2);
  results[0].hard_case = results[1].hard_case = hard_cases().front();
  results[0].passed = true;
  results[1].reason = "why";
  const nlohmann::json json = stability_json(results);
  EXPECT_EQ(json["passed"], 1);
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["cases"][1]["passed"], false);
  EXPECT_EQ(json["cases"][1]["reason"], "why");
}

TEST(Catalogue, CountsTheSolvesThatTakeMorePassesThanTheyMay) {
  CharacterReport report;
  report.outer_passes = report.substeps = 1;
  Measurement usual;
  for (int n = 0; n < 1000; ++n) usual.count(report);
  EXPECT_EQ(excess_of(usual), "");
  Measurement seldom = usual, often = usual;
  report.outer_passes = 16;
  for (int n = 0; n < 5; ++n) seldom.count(report);
  EXPECT_EQ(excess_of(seldom), "") << "16 passes, in less than one of 100";
  for (int n = 0; n < 20; ++n) often.count(report);
  EXPECT_NE(excess_of(often), "") << "16 passes in two of 100";
  report.outer_passes = 17;
  seldom.count(report);
  EXPECT_NE(excess_of(seldom), "") << "17 passes";
  report.substeps = 2;
  usual.count(report);
  EXPECT_EQ(excess_of(usual), "") << "17 passes of a step in two parts are nine each";
}

TEST(Catalogue, ComparesTheSlowestStepWithTheMedian) {
  Measurement m;
  EXPECT_EQ(m.slowest_over_median(), 0);
  m.solved_us = {3, 1, 2, 30, 2};
  EXPECT_EQ(m.slowest_over_median(), 15);
}

TEST(Catalogue, RunsACaseAgainBeforeItSaysThatAStepIsSlow) {
  static int runs = 0;
  HardCase slow_once;
  slow_once.name = "slow_once", slow_once.row = slow_once.source = slow_once.criterion = "";
  slow_once.scene = "free_flight", slow_once.steps = {1.0 / 60};
  slow_once.in_double = [](const Trial&) {
    Measurement m;
    m.solved_us = {1, 1, ++runs == 1 ? 50.0f : 2.0f};
    return Verdict(m);
  };
  StabilityResult result = run_case(slow_once, true);
  EXPECT_EQ(result.rows.at(0).slowest, 50);
  double now = 0;  // a quiet machine's clocks: both go on alike
  const Clocks clocks{[&] { return now; }, [&] { return now; }};
  judge_times(result, true, MachineCheck(clocks, [&] { now += 0.01; }));
  EXPECT_EQ(result.rows.at(0).slowest, 2);
  EXPECT_EQ(result.slow, "");
}

TEST(Catalogue, IsEmptyForAnUnknownName) {
  EXPECT_TRUE(run_stability({true, "no such case"}, {}, {}).empty());
}

}  // namespace
}  // namespace sinew::study
