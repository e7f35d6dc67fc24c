// The scenes of the seed talk, as `sinew study talk --quick` judges them.
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <set>

#include "fixtures/paths.h"
#include "study/talk/talk.h"

namespace sinew::study {

void PrintTo(const Situation& situation, std::ostream* out) {
  *out << situation.name << ": " << situation.about;
}

namespace {

class Talk : public testing::TestWithParam<Situation> {};

TEST_P(Talk, SceneShowsWhatTheTalkSays) {
  const SituationResult result = run_situation(GetParam(), true);
  ASSERT_EQ(result.findings.refused(), "");
  EXPECT_TRUE(result.findings.passed()) << situation_table(result);
}

INSTANTIATE_TEST_SUITE_P(All, Talk, testing::ValuesIn(talk_scenes()),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(TalkScenes, AreAllJudged) {
  std::set<std::string> files, judged;
  for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/assets/scenes/talk"))
    if (entry.path().extension() == ".json") files.insert(entry.path().stem().string());
  for (const Situation& situation : talk_scenes()) judged.insert(situation.name);
  EXPECT_EQ(files, judged);
}

}  // namespace
}  // namespace sinew::study
