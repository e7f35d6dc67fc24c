// Characters and captures that others made, without a word about their joints.
#include "fixtures/known_failure.h"
#include "retarget/figures.h"

namespace sinew::retarget::test {
namespace {

class Foreign : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(file_)) GTEST_SKIP() << file_ << " is not there";
  }
  const std::string file_ = shared_dir() + "/assets/" + GetParam();
};

using ForeignCharacter = Foreign;
using ForeignMotion = Foreign;

void expect_stands(const nlohmann::json& clip) {
  const std::string what = clip.dump();
  EXPECT_GE(clip["sole_lowest_mm"].get<double>(), -3) << what;
  EXPECT_LE(clip["sole_highest_mm"].get<double>(), 3) << what;
  EXPECT_LE(clip["slide_mm"].get<double>(), 5) << what;
  EXPECT_EQ(clip["knee_beyond_range_deg"].get<double>(), 0) << what;
}

TEST_P(ForeignCharacter, WalksAsTheMannequinDoes) {
  const Asset target = converted(file_);
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  const Error error = retarget_clips(mannequin(), target, options, out, report);
  ASSERT_FALSE(error) << error.message;
  expect_stands(report["clips"][0]);
  EXPECT_GE(report["chains"].size(), 15u);
  // Limbs point where the mannequin's do, but for what the soles ask of legs; of KayKit's, whose feet are
  // long for their legs and lift the heels accordingly, only arms are alike.
  const bool long_feet = file_.find("kaykit") != std::string::npos;
  const Motion a = sample_motion(mannequin().clips[std::size_t(mannequin().find_clip("walk"))],
                                 mannequin().skeleton, 240),
               b = sample_motion(out.clips[0], out.skeleton, 240);
  const auto way = [](const Asset& asset, const Motion& motion, std::size_t frame, Role from, Role to) {
    return Vec3<double>(motion.model[frame][asset.skeleton.find(to)].translation -
                        motion.model[frame][asset.skeleton.find(from)].translation)
        .normalized();
  };
  for (std::size_t f = 0; f < std::min(a.model.size(), b.model.size()); f += 16) {
    for (const auto& [from, to] :
         {std::pair(Role::kThighL, Role::kShinL), std::pair(Role::kShinR, Role::kFootR),
          std::pair(Role::kUpperArmL, Role::kForearmL)}) {
      if (long_feet && from != Role::kUpperArmL) continue;
      EXPECT_GT(way(mannequin(), a, f, from, to).dot(way(out, b, f, from, to)), std::cos(15 * kDegree)) << f;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, ForeignCharacter,
                         testing::Values("gltf/kaykit_knight.glb", "gltf/kaykit_manny/manny_med_mod.gltf",
                                         "fbx/geno.fbx", "fbx/pab_arnaud.fbx", "dae/walk.dae"));

TEST_P(ForeignMotion, StandsOnTheMannequinsSoles) {
  Asset out;
  nlohmann::json report;
  Options options;
  if (file_.find("knight") != std::string::npos) options.clips = {"Idle", "Walking_A"};
  const Error error = retarget_clips(converted(file_), mannequin(), options, out, report);
  ASSERT_FALSE(error) << error.message;
  for (const auto& clip : report["clips"]) expect_stands(clip);
}

INSTANTIATE_TEST_SUITE_P(Shared, ForeignMotion,
                         testing::Values("gltf/kaykit_knight.glb", "bvh/jesse_dance.bvh",
                                         "bvh/fair_jumping.bvh", "bvh/fair_zombie.bvh",
                                         "bvh/cmu_01_01_jumps.bvh", "bvh/cmu_13_26.bvh",
                                         "fbx/cmu_09_11_run.fbx", "fbx/cmu_49_08_cartwheel.fbx",
                                         "fbx/pab_locomotions.fbx", "dae/walk.dae"));

TEST(ForeignSquats, StandOnTheMannequinsSoles) {
  const std::string file = shared_dir() + "/assets/bvh/boxing_toes.bvh";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  Asset out;
  nlohmann::json report;
  const Error error = retarget_clips(converted(file), mannequin(), {}, out, report);
  ASSERT_FALSE(error) << error.message;
  const nlohmann::json& clip = report["clips"][0];
  EXPECT_EQ(clip["knee_beyond_range_deg"].get<double>(), 0);
  SINEW_FAILS_TODAY(
      clip["sole_highest_mm"].get<double>() <= 3 && clip["slide_mm"].get<double>() <= 5,
      "the boxer squats lower than the mannequin's knees fold, whose hips rise by 12 % of the leg at "
      "most; soles lift by 65 mm there and slide by 28");
}

TEST(ForeignCharacterWithoutNames, IsRefusedByName) {
  const std::string file = shared_dir() + "/assets/gltf/cesium_man.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  Asset out;
  nlohmann::json report;
  const Error error = retarget_clips(mannequin(), converted(file), {}, out, report);
  EXPECT_NE(error.message.find("the target: none of its 19 joints"), std::string::npos) << error.message;
}

}  // namespace
}  // namespace sinew::retarget::test
