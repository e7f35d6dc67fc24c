// Poses of the sample asset on both sides of the C interface, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "c/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/io/asset.h"

namespace sinew::fixtures {

using Jets = std::vector<JointJet<float>>;

/// The sample asset on both sides, and poses of its clips, which have the same bytes on both.
struct CInterfacePoses : ::testing::Test {
  Asset cpp;
  sinew_asset asset = 0;
  std::vector<int> parents;
  std::vector<Transform<float>> rest;
  int joints = 0;

  void SetUp() override {
    ASSERT_TRUE(load_asset(sample_asset().c_str(), cpp));
    ASSERT_EQ(sinew_asset_load(sample_asset().c_str(), &asset), SINEW_OK);
    for (const Joint& joint : cpp.skeleton.joints) {
      parents.push_back(joint.parent);
      rest.push_back(joint.rest.cast<float>());
    }
    joints = static_cast<int>(parents.size());
  }
  void TearDown() override { EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK); }

  Jets pose(const char* clip, double time) const {
    Jets jets(parents.size());
    EXPECT_TRUE((SamplingJob<float>{&cpp.clips[std::size_t(cpp.find_clip(clip))], time, jets}.Run()));
    return jets;
  }
  static sinew_jet* c(Jets& jets) { return reinterpret_cast<sinew_jet*>(jets.data()); }
  static const sinew_jet* c(const Jets& jets) { return reinterpret_cast<const sinew_jet*>(jets.data()); }
  int joint(Role role) const { return cpp.skeleton.find(role); }
  std::vector<sinew_transform> model(const Jets& jets) const {
    std::vector<sinew_transform> out(jets.size());
    std::int32_t count = 0;
    EXPECT_EQ(sinew_asset_get_model(asset, c(jets), joints, out.data(), joints, &count), SINEW_OK)
        << sinew_last_reason();
    EXPECT_EQ(count, joints);
    return out;
  }
};

inline void expect_same(const Jets& a, const Jets& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_EQ(a[j].rotation.coeffs(), b[j].rotation.coeffs()) << j;
    EXPECT_EQ(a[j].omega, b[j].omega) << j;
    EXPECT_EQ(a[j].alpha, b[j].alpha) << j;
    EXPECT_EQ(a[j].translation, b[j].translation) << j;
    EXPECT_EQ(a[j].velocity, b[j].velocity) << j;
    EXPECT_EQ(a[j].acceleration, b[j].acceleration) << j;
  }
}

inline void expect_refused(sinew_status status, sinew_status wanted, const char* reason) {
  EXPECT_EQ(status, wanted) << reason;
  EXPECT_NE(std::string(sinew_last_reason()).find(reason), std::string::npos) << sinew_last_reason();
}

}  // namespace sinew::fixtures
