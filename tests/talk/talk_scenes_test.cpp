// The scenes of the seed talk, as `sinew study talk --quick` judges them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
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

TEST(TalkScenes, PageHasAPictureOfEach) {
  const std::string folder = source_dir() + "/assets/scenes/talk/";
  std::ifstream in(folder + "README.md");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  for (const Situation& situation : talk_scenes()) {
    std::string name = situation.name;
    if (name == "baked_as_in_the_talk") name = "baked";  // a row of that picture
    EXPECT_NE(page.find("](pictures/" + name + ".jpg)"), std::string::npos) << name;
    std::error_code missing;
    const auto size = std::filesystem::file_size(folder + "pictures/" + name + ".jpg", missing);
    EXPECT_FALSE(missing) << name;
    EXPECT_LT(size, 60000u) << name << ": too large for a page";
  }
}

}  // namespace
}  // namespace sinew::study
