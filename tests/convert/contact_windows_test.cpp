// When feet rest on the floor, of clips whose steps are known.
#include "convert/contact_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "convert/convert.h"
#include "fixtures/paths.h"

namespace sinew::convert {
namespace {

Asset converted(const std::string& file, nlohmann::json& report) {
  Asset asset;
  const Error error = convert_files({file}, {}, asset, report);
  EXPECT_FALSE(error) << error.message;
  return asset;
}

std::vector<ContactWindow> windows_of(const Asset& asset, const Clip& clip, Role role) {
  std::vector<ContactWindow> found;
  for (const ContactWindow& w : clip.contacts)
    if (asset.skeleton.joints[std::size_t(w.joint)].role == role) found.push_back(w);
  return found;
}

TEST(FloorOf, IsWhereTheLowestPointIsMostOften) {
  EXPECT_EQ(floor_of({}), 0);
  EXPECT_NEAR(floor_of({0.5, 0.101, 0.1, 0.102, 0.9, -0.03, 0.7}), 0.101, 2e-3);
}

class DemoContacts : public testing::Test {
 protected:
  const Clip& clip(const char* name) const { return asset_.clips[std::size_t(asset_.find_clip(name))]; }
  nlohmann::json report_;
  const Asset asset_ = converted(source_dir() + "/assets/character/mannequin.glb", report_);
};

TEST_F(DemoContacts, WalkingFeetRestForSixtyPercentOfTheCycleAndOverlap) {
  const Clip& walk = clip("walk");
  for (const Role role : {Role::kFootL, Role::kFootR}) {
    const auto windows = windows_of(asset_, walk, role);
    ASSERT_EQ(windows.size(), 1u);
    const float share = (windows[0].end - windows[0].begin) / walk.duration;
    EXPECT_GT(share, 0.55f);  // published walks: 0.58 to 0.64
    EXPECT_LT(share, 0.67f);
  }
}

TEST_F(DemoContacts, RunningFeetRestForLessThanHalfOfIt) {
  const Clip& run = clip("run");
  for (const Role role : {Role::kFootL, Role::kFootR}) {
    const auto windows = windows_of(asset_, run, role);
    ASSERT_EQ(windows.size(), 1u);
    const float share = (windows[0].end - windows[0].begin) / run.duration;
    EXPECT_GT(share, 0.3f);
    EXPECT_LT(share, 0.45f);
  }
}

TEST_F(DemoContacts, WhoStandsRestsAllTheTimeAndWhoGetsUpLeansOnItsHandsFirst) {
  for (const Role role : {Role::kFootL, Role::kFootR}) {
    const auto windows = windows_of(asset_, clip("stand"), role);
    ASSERT_EQ(windows.size(), 1u);
    EXPECT_GT(windows[0].end - windows[0].begin, 0.99f * clip("stand").duration);
  }
  const auto hands = windows_of(asset_, clip("get_up_prone"), Role::kHandL);
  ASSERT_FALSE(hands.empty());
  EXPECT_LT(hands.back().end, 0.75f * clip("get_up_prone").duration);  // its squat begins at 0.74
}

TEST_F(DemoContacts, GiveLoopsTheirMarkersAndOthersNone) {
  for (const char* name : {"walk", "run"}) {
    EXPECT_EQ(clip(name).cycles, 1) << name;
    ASSERT_EQ(clip(name).markers.size(), 2u) << name;
    EXPECT_EQ(clip(name).markers[1].phase, 0.5) << name;
    const auto left = windows_of(asset_, clip(name), Role::kFootL);
    EXPECT_FLOAT_EQ(static_cast<float>(clip(name).markers[0].time), left[0].begin) << name;
  }
  EXPECT_TRUE(clip("stand").markers.empty());
  EXPECT_TRUE(clip("get_up_prone").markers.empty());
}

class SharedContacts : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(root_)) GTEST_SKIP() << root_ << " is not there";
  }
  const std::string root_ = shared_dir() + "/assets";
};

TEST_F(SharedContacts, CapturedWalkTakesTurns) {
  nlohmann::json report;
  const Asset asset = converted(root_ + "/bvh/cmu_12_01_walk.bvh", report);
  const Clip& walk = asset.clips[0];
  std::vector<ContactWindow> steps = windows_of(asset, walk, Role::kFootL);
  const std::vector<ContactWindow> right = windows_of(asset, walk, Role::kFootR);
  EXPECT_EQ(steps.size(), 4u);
  EXPECT_EQ(right.size(), 4u);
  steps.insert(steps.end(), right.begin(), right.end());
  std::sort(steps.begin(), steps.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
  for (std::size_t k = 1; k < steps.size(); ++k) EXPECT_NE(steps[k].joint, steps[k - 1].joint) << k;
}

TEST_F(SharedContacts, JumpsAreInTheAirTwiceAndLoopsThatBeginOnTheRightHaveMarkers) {
  nlohmann::json report;
  const Asset jumps = converted(root_ + "/bvh/fair_jumping.bvh", report);
  EXPECT_EQ(windows_of(jumps, jumps.clips[0], Role::kFootL).size(), 3u);
  EXPECT_EQ(windows_of(jumps, jumps.clips[0], Role::kFootR).size(), 3u);
  const Asset steps = converted(root_ + "/fbx/pab_locomotions.fbx", report);
  for (const Clip& clip : steps.clips) {
    ASSERT_EQ(clip.markers.size(), 2u) << clip.name;
    EXPECT_GT(clip.markers[1].time, double(clip.duration)) << clip.name;
  }
}

TEST_F(SharedContacts, KnightsWalkInPlaceIsFound) {
  nlohmann::json report;
  const Asset asset = converted(root_ + "/gltf/kaykit_knight.glb", report);
  const std::string notes = report["notes"].dump();
  EXPECT_NE(notes.find("clip 'Walking_A' moves in place"), std::string::npos) << notes;
  EXPECT_EQ(notes.find("clip 'Idle' moves in place"), std::string::npos) << notes;
  const Clip& walk = asset.clips[std::size_t(asset.find_clip("Walking_A"))];
  EXPECT_EQ(windows_of(asset, walk, Role::kFootL).size(), 1u);
  EXPECT_EQ(windows_of(asset, walk, Role::kFootR).size(), 1u);
  EXPECT_EQ(walk.markers.size(), 2u);
}

}  // namespace
}  // namespace sinew::convert
