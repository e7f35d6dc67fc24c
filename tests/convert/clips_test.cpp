// The demo character's clips: what they ask of a body of 75 kg, and whether their feet stand still.
#include <gtest/gtest.h>

#include <map>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/residual/tree.h"

namespace sinew::convert {
namespace {

const std::string kMannequin = source_dir() + "/assets/character/mannequin.glb";

/// Highest torque [N·m] that one clip asks of each joint.
std::map<std::string, double> peaks(const std::string& clip, Asset& asset) {
  nlohmann::json report;
  const auto fault =
      convert_files({kMannequin}, {{"total_mass", 75}, {"fit_degree", 5}, {"clips", {clip}}}, asset, report);
  EXPECT_FALSE(fault);
  std::map<std::string, double> out;
  for (const auto& row : report["muscles"]) out[row["joint"]] = row["clips_peak_Nm"];
  return out;
}

struct Asked {
  const char* clip;
  double hip, knee, ankle, spine;  ///< N·m
};
/// Published for 75 kg: walking 45–105 N·m of the hip, 40–57 of the knee, 92–133 of the ankle; running 190,
/// 131–270 and 235 (Gait2392, Rajagopal 2016 and Hamner's runner). A third is left for the style of one
/// person; getting up has no published peaks: no more than maximal strength, 5 N·m/kg.
class Clips : public testing::TestWithParam<Asked> {};

TEST_P(Clips, AskOfTheLegsWhatPeopleCanGive) {
  const Asked& a = GetParam();
  Asset asset;
  auto most = peaks(a.clip, asset);
  for (const std::string side : {"_l", "_r"}) {
    EXPECT_LT(most["thigh" + side], a.hip);
    EXPECT_LT(most["shin" + side], a.knee);
    EXPECT_LT(most["foot" + side], a.ankle);
  }
  EXPECT_LT(most["spine_01"], a.spine);
}

INSTANTIATE_TEST_SUITE_P(All, Clips,
                         testing::Values(Asked{"stand", 20, 20, 40, 30}, Asked{"walk", 140, 76, 177, 60},
                                         Asked{"run", 253, 360, 313, 120},
                                         Asked{"get_up_supine", 375, 375, 375, 375},
                                         Asked{"get_up_prone", 375, 375, 375, 375}),
                         [](const auto& of) { return std::string(of.param.clip); });

/// Paths [frame] of a joint's origin over one pass of a clip, 120 frames a second.
std::vector<Vec3<double>> path(const Asset& asset, const char* joint) {
  const Tree<double> tree(asset.skeleton);
  Kinematics<double> kinematics(tree);
  Motion<double> motion(tree);
  std::vector<Vec3<double>> force(tree.bodies), moment(tree.bodies), out;
  std::vector<JointJet<double>> jets(asset.skeleton.joints.size());
  const int index = asset.skeleton.find(joint);
  for (int f = 0; f < static_cast<int>(120 * asset.clips[0].duration); ++f) {
    const SamplingJob<double> job{&asset.clips[0], f / 120.0, jets};
    EXPECT_TRUE(job.Run());
    inertial_wrenches<double>(tree, jets, {0, 0, -9.81}, Vec3<double>::Zero(), kinematics, motion, force,
                              moment);
    out.push_back(kinematics.origin[index]);
  }
  return out;
}

TEST(ClipFeet, StandStillBetweenHeelStrikeAndHeelRise) {
  struct Window {
    const char* clip;
    double from, to;  ///< share of the cycle in which the right foot is flat
  };
  for (const Window& w : {Window{"walk", 0.10, 0.32}, Window{"run", 0.08, 0.12}}) {
    Asset asset;
    peaks(w.clip, asset);
    const auto foot = path(asset, "foot_r");
    const auto at = [&](double share) { return foot[static_cast<std::size_t>(share * double(foot.size()))]; };
    // 2 mm: what a published walk that was fitted to its feet slips by.
    for (double share = w.from; share < w.to; share += 0.005)
      EXPECT_LT((at(share) - at(w.from)).norm(), 0.002) << w.clip << " at " << share;
    EXPECT_GT((foot.back() - foot.front()).norm(), 1.0) << w.clip;
  }
}

}  // namespace
}  // namespace sinew::convert
