// The set-ups of the hard cases are scene files that `sinew simulate` and `sinew render` take as well.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "fixtures/paths.h"
#include "scene/run.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

namespace fs = std::filesystem;

std::set<std::string> files_in_folder() {
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(source_dir() + "/assets/scenes/hard_cases"))
    files.insert(entry.path().filename().string());
  return files;
}

TEST(SceneFiles, AreTheSetUpOfEveryCaseButThoseThatCannotHaveOne) {
  std::set<std::string> used, without;
  for (const HardCase& c : hard_cases()) {
    const std::string file = scene_file(c);
    if (file.empty())
      without.insert(c.name);
    else
      used.insert(fs::path(file).filename().string());
    EXPECT_EQ(file.empty(), why_without_scene(c.name) != nullptr) << c.name;
  }
  EXPECT_EQ(used, files_in_folder()) << "a case without its file, or a file that no case asks for";
  EXPECT_EQ(without, (std::set<std::string>{"baked_limbs", "denormal_speeds", "random_trees", "soak_hour"}));
}

class SceneFile : public testing::TestWithParam<std::string> {};

TEST_P(SceneFile, RunsAsAScene) {
  scene::Scene scene;
  const convert::Error error =
      scene::load_scene(source_dir() + "/assets/scenes/hard_cases/" + GetParam(), scene);
  ASSERT_FALSE(error) << error.message;
  EXPECT_NE(scene.title, "");
  scene.duration = 4 / scene.frame_rate;
  scene::Recording recording;
  scene::Telemetry telemetry;
  const convert::Error failed = scene::run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(failed) << failed.message;
  ASSERT_EQ(recording.frames.size(), 5u);
  for (const scene::Frame& frame : recording.frames) {
    for (const scene::CharacterFrame& c : frame.characters)
      for (const Transform<float>& joint : c.model) EXPECT_TRUE(joint.translation.allFinite());
    for (const scene::PropFrame& prop : frame.props) EXPECT_TRUE(prop.world.translation.allFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(HardCases, SceneFile, testing::ValuesIn(files_in_folder()),
                         [](const testing::TestParamInfo<std::string>& of) {
                           return fs::path(of.param).stem().string();
                         });

}  // namespace
}  // namespace sinew::study
