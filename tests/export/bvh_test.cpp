// BVH files: the same motion for whoever reads them.
#include "export/bvh.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include "importer.h"

namespace sinew::exporting::test {
namespace {

std::string bvh_of(const Skeleton& skeleton, const Motion& motion) {
  std::string text;
  std::vector<std::string> notes;
  const convert::Error error = write_bvh(skeleton, motion, text, notes);
  EXPECT_FALSE(error) << error.message;
  return text;
}

void expect_read_back(const Asset& asset, const Clip& clip) {
  Motion motion = sample_clip(asset, clip, 60, Keys::kEven);
  import::SourceScene scene;
  std::string error;
  ASSERT_TRUE(import::read_source(written("back.bvh", bvh_of(asset.skeleton, motion)), {}, scene, error))
      << error;
  ASSERT_EQ(scene.clips.size(), 1u);
  EXPECT_NEAR(scene.clips[0].duration, double(clip.duration), 1e-5) << clip.name;
  motion.name = scene.clips[0].name;
  EXPECT_LT(furthest_in_importer(scene, asset.skeleton, motion), kSamePlace) << clip.name;
}

TEST(BvhExport, ImporterFindsEveryJointWhereItWasInAllFrames) {
  const Asset asset = mannequin();
  for (const Clip& clip : asset.clips) expect_read_back(asset, clip);
}

TEST(BvhExport, BlenderFindsEveryJointWhereItWasInAllFrames) {
  const Asset asset = mannequin();
  const Motion motion = sample_clip(
      asset, asset.clips[static_cast<std::size_t>(asset.find_clip("get_up_supine"))], 60, Keys::kEven);
  expect_same_in_blender(written("motion.bvh", bvh_of(asset.skeleton, motion)),
                         {track_of(asset.skeleton, motion)});
}

/// Two joints, of which the second moves away from the first by and by, and turns through all that three
/// angles find hard: half turns, and the middle angle at 90 degrees.
struct Slider {
  Skeleton skeleton;
  Motion motion{"slide", nullptr, {}, {}};

  Slider() {
    skeleton.joints.resize(2);
    skeleton.joints[0].name = "base";
    skeleton.joints[1].name = "slider";
    skeleton.joints[1].parent = 0;
    skeleton.joints[1].rest.translation = {0.1, 0.2, 0.3};
    skeleton.joints[1].rest.rotation = Quat<double>(0.5, 0.5, -0.5, 0.5);
    for (int k = 0; k <= 96; ++k) {
      std::vector<JointJet<double>> frame(2);
      const double angle = k * std::numbers::pi / 12;
      const Vec3<double> axis = k < 32   ? Vec3<double>::UnitX()
                                : k < 64 ? Vec3<double>::UnitY()
                                         : Vec3<double>::UnitZ();
      frame[0].rotation = Eigen::AngleAxisd(angle, axis);
      frame[0].translation = {0, 0, 0.01 * k};
      frame[1].rotation = skeleton.joints[1].rest.rotation * frame[0].rotation;
      frame[1].translation = skeleton.joints[1].rest.translation + Vec3<double>(0.001 * k, 0, 0);
      motion.times.push_back(k / 24.0);
      motion.frames.push_back(frame);
    }
  }
};

TEST(BvhExport, HoldsJointsThatLeaveTheirPlaceAndTurnAnyWay) {
  Slider slider;
  import::SourceScene scene;
  std::string error;
  const std::string path = written("slider.bvh", bvh_of(slider.skeleton, slider.motion));
  ASSERT_TRUE(import::read_source(path, {}, scene, error)) << error;
  Motion motion = slider.motion;
  motion.name = scene.clips[0].name;
  EXPECT_LT(furthest_in_importer(scene, slider.skeleton, motion), kSamePlace);
}

TEST(BvhExport, BlenderReadsJointsThatLeaveTheirPlace) {
  const Slider slider;
  expect_same_in_blender(written("slider.bvh", bvh_of(slider.skeleton, slider.motion)),
                         {track_of(slider.skeleton, slider.motion)});
}

// Lines between frames then go the short way: no angle leaps by more than a joint turns in a sixtieth of a
// second.
TEST(BvhExport, AnglesDoNotLeap) {
  const Asset asset = mannequin();
  const Motion motion =
      sample_clip(asset, asset.clips[static_cast<std::size_t>(asset.find_clip("run"))], 60, Keys::kEven);
  std::istringstream text(bvh_of(asset.skeleton, motion));
  std::string line;
  while (std::getline(text, line) && line.rfind("Frame Time", 0) != 0) continue;
  std::vector<double> before;
  int rows = 0;
  for (; std::getline(text, line); ++rows) {
    std::istringstream numbers(line);
    std::vector<double> row{std::istream_iterator<double>(numbers), {}};
    for (std::size_t c = 3; c < row.size() && !before.empty(); ++c)
      EXPECT_LT(std::abs(row[c] - before[c]), 90);
    before = row;
  }
  EXPECT_EQ(rows, static_cast<int>(motion.times.size()));
}

TEST(BvhExport, SeveralRootsAreRefusedAndNamesHaveNoSpaces) {
  Slider slider;
  std::string text;
  std::vector<std::string> notes;
  slider.skeleton.joints[1].name = "my slider";
  EXPECT_FALSE(write_bvh(slider.skeleton, slider.motion, text, notes));
  EXPECT_NE(text.find("JOINT my_slider\n"), std::string::npos);
  ASSERT_EQ(notes.size(), 1u);
  slider.skeleton.joints[1].parent = -1;
  const convert::Error error = write_bvh(slider.skeleton, slider.motion, text, notes);
  EXPECT_NE(error.message.find("2 roots ('base', 'my slider')"), std::string::npos) << error.message;
}

class ForeignMotion : public testing::TestWithParam<const char*> {};

TEST_P(ForeignMotion, IsReadBack) {
  const std::string path = shared_asset(GetParam());
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no ../shared here: " << GetParam() << " was not exported";
  const Asset asset = converted(path);
  ASSERT_FALSE(asset.clips.empty());
  expect_read_back(asset, asset.clips[0]);
}

INSTANTIATE_TEST_SUITE_P(Files, ForeignMotion,
                         testing::Values("bvh/cmu_12_01_walk.bvh", "bvh/jesse_dance.bvh",
                                         "bvh/fair_zombie.bvh", "gltf/fox.glb", "fbx/cmu_09_11_run.fbx",
                                         "dae/walk.dae"));

}  // namespace
}  // namespace sinew::exporting::test
