// Every case of the catalogue passes, or is on the one list of known failures and still fails.
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

TEST(Catalogue, IsEmptyForAnUnknownName) {
  EXPECT_TRUE(run_stability({true, "no such case"}, {}, {}).empty());
}

}  // namespace
}  // namespace sinew::study
