// Whole clips for other bodies: what stands stands, what clips say comes along, bad input is named.
#include <cmath>
#include <limits>

#include "fixtures/known_failure.h"
#include "retarget/figures.h"

namespace sinew::retarget::test {
namespace {

const Clip& clip_of(const Asset& asset, const char* name) {
  return asset.clips[std::size_t(asset.find_clip(name))];
}

/// The bounds asked for, on the clip as it is played.
void expect_stands(const nlohmann::json& clip, const std::string& who) {
  EXPECT_GE(clip["contacts"].get<int>(), 2) << who;
  EXPECT_GE(clip["sole_lowest_mm"].get<double>(), -3) << who;
  EXPECT_LE(clip["sole_highest_mm"].get<double>(), 3) << who;
  EXPECT_LE(clip["slide_mm"].get<double>(), 5) << who;
  EXPECT_EQ(clip["knee_beyond_range_deg"].get<double>(), 0) << who;
}

class Sizes : public testing::TestWithParam<double> {};

TEST_P(Sizes, WalkAndRunStandOnTheirSoles) {
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk", "run", "stand"};
  const Error error = retarget_clips(mannequin(), mannequin(GetParam()), options, out, report);
  ASSERT_FALSE(error) << error.message;
  for (const auto& clip : report["clips"]) expect_stands(clip, clip["name"]);
}

TEST_P(Sizes, CapturedWalkStandsOnItsSoles) {
  const std::string file = shared_dir() + "/assets/bvh/cmu_12_01_walk.bvh";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  Asset out;
  nlohmann::json report;
  const Error error = retarget_clips(converted(file), mannequin(GetParam()), {}, out, report);
  ASSERT_FALSE(error) << error.message;
  EXPECT_EQ(report["clips"][0]["contacts"], 8);
  expect_stands(report["clips"][0], file);
}

INSTANTIATE_TEST_SUITE_P(Metres, Sizes, testing::Values(0.9, 1.75, 2.5));

TEST_P(Sizes, GettingUpStandsOnSolesAndHands) {
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"get_up_supine", "get_up_prone"};
  ASSERT_FALSE(retarget_clips(mannequin(), mannequin(GetParam()), options, out, report));
  double highest = 0, slide = 0;
  for (const auto& clip : report["clips"]) {
    EXPECT_GE(clip["sole_lowest_mm"].get<double>(), -3);
    EXPECT_EQ(clip["knee_beyond_range_deg"].get<double>(), 0);
    highest = std::max(highest, clip["sole_highest_mm"].get<double>());
    slide = std::max(slide, clip["slide_mm"].get<double>());
  }
  SINEW_FAILS_TODAY(
      highest <= 3 && slide <= 5,
      "a hand that is counted as resting is further from the floor than its arm is long: 5 to 14 mm");
}

TEST(Retarget, TravelGrowsWithTheLegs) {
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  ASSERT_FALSE(retarget_clips(mannequin(), mannequin(2.5), options, out, report));
  const double ratio = 2.5 / 1.75;
  EXPECT_NEAR(report["scale"].get<double>(), ratio, 1e-6);
  const Clip &before = clip_of(mannequin(), "walk"), &after = out.clips[0];
  EXPECT_NEAR(double(after.root_step.x()), ratio * double(before.root_step.x()), 1e-3);  // m: the fit's own
  EXPECT_EQ(after.duration, before.duration);
}

TEST(Retarget, WhatAClipSaysComesAlongInItsTime) {
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  options.froude = true;
  ASSERT_FALSE(retarget_clips(mannequin(), mannequin(0.9), options, out, report));
  const Clip &before = clip_of(mannequin(), "walk"), &after = out.clips[0];
  const double pace = std::sqrt(0.9 / 1.75);  // the same Froude number: times as the root of lengths
  EXPECT_NEAR(after.duration, pace * double(before.duration), 1e-5);
  ASSERT_EQ(after.contacts.size(), before.contacts.size());
  ASSERT_FALSE(before.events.empty());
  ASSERT_EQ(after.events.size(), before.events.size());
  ASSERT_EQ(after.markers.size(), before.markers.size());
  for (std::size_t k = 0; k < before.events.size(); ++k) {
    EXPECT_NEAR(after.events[k].begin, pace * double(before.events[k].begin), 1e-5);
    EXPECT_EQ(after.events[k].name, before.events[k].name);
  }
  for (std::size_t k = 0; k < before.markers.size(); ++k)
    EXPECT_NEAR(after.markers[k].time, pace * before.markers[k].time, 1e-5);
  for (const CurveSlot& slot : mannequin().curve_slots) EXPECT_GE(out.find_curve(slot.name), 0) << slot.name;
  EXPECT_EQ(after.curves.size(), before.curves.size());
  expect_stands(report["clips"][0], "walk");
  Asset again;
  const std::vector<std::uint8_t> bytes = write_asset(out);
  EXPECT_TRUE(read_asset(bytes, again));  // what a game would load
  EXPECT_EQ(again.clips[0].events.size(), before.events.size());
}

TEST(Retarget, MorphTargetsStayWithTheTargetAndFollowTheSourcesCurves) {
  Asset source = mannequin(), target = mannequin(0.9), out;
  const auto add_face = [](Asset& asset, const std::vector<std::string>& names) {
    Mesh& mesh = asset.meshes[0];
    for (const std::string& name : names) {
      mesh.morphs.push_back({{{0, 1}}, {0, 0, 1}, 0.01f, {}, 0});
      mesh.morph_curves.push_back(static_cast<int>(asset.curve_slots.size()));
      asset.curve_slots.push_back({name, 0});
    }
  };
  add_face(source, {"blink", "smile"});
  add_face(target, {"smile", "frown"});
  const int slot = source.find_curve("smile");
  Clip& walk = source.clips[std::size_t(source.find_clip("walk"))];
  walk.curves.push_back({slot, walk.duration, {0.75f}});
  if (!walk.loops) walk.curves.back().controls.assign(4, 0.75f);
  Options options;
  options.clips = {"walk"};
  nlohmann::json report;
  const Error error = retarget_clips(source, target, options, out, report);
  ASSERT_FALSE(error) << error.message;
  Asset back;
  ASSERT_TRUE(read_asset(write_asset(out), back));
  const Mesh& mesh = back.meshes[0];
  ASSERT_EQ(mesh.morphs.size(), 2u);
  const auto curve = [&](std::size_t morph) {
    return back.curve_slots[std::size_t(mesh.morph_curves[morph])].name;
  };
  EXPECT_EQ(curve(0), "smile");
  EXPECT_EQ(curve(1), "frown");
  const auto& curves = back.clips[0].curves;
  const auto moved = std::find_if(curves.begin(), curves.end(),
                                  [&](const FloatCurve& c) { return c.slot == mesh.morph_curves[0]; });
  ASSERT_NE(moved, curves.end());
  EXPECT_EQ(moved->controls[0], 0.75f);
}

TEST(Retarget, AnotherRestPoseIsNoOtherMotion) {
  Asset odd = mannequin();
  turn_rest(odd.skeleton, Role::kUpperArmL, {1.0, 0, 0});
  turn_rest(odd.skeleton, Role::kUpperArmR, {-1.0, 0, 0});
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  ASSERT_FALSE(retarget_clips(mannequin(), odd, options, out, report));
  const Motion a = sample_motion(clip_of(mannequin(), "walk"), mannequin().skeleton, 240),
               b = sample_motion(out.clips[0], odd.skeleton, 240);
  // What planting takes from this walk: soles that sink in by 11 mm and slide by 15, and the knees with them;
  // bones of the trunk turn by no more than the fit's millimetre over 10 cm.
  const int chest = odd.skeleton.find(Role::kChest), hand = odd.skeleton.find(Role::kHandL);
  for (std::size_t f = 0; f < a.model.size(); ++f)
    for (const int joint : {chest, hand}) {
      const Vec3<double> from_head_a = a.model[f][joint].translation - a.model[f][0].translation,
                         from_head_b = b.model[f][joint].translation - b.model[f][0].translation;
      EXPECT_LT((from_head_a - from_head_b).norm(), 3e-3) << f;
    }
  EXPECT_LT(distance(a, b), 0.04);
}

TEST(Retarget, TorquesAreSharesOfTheTargetsMuscles) {
  Asset weak = mannequin(), out;
  for (Joint& joint : weak.skeleton.joints)
    for (DofLimits& dof : joint.dofs) {
      dof.torque_minus /= 2;
      dof.torque_plus /= 2;
    }
  nlohmann::json strong_report, weak_report;
  Options options;
  options.clips = {"stand"};
  ASSERT_FALSE(retarget_clips(mannequin(), mannequin(), options, out, strong_report));
  ASSERT_FALSE(retarget_clips(mannequin(), weak, options, out, weak_report));
  const auto &strong = strong_report["clips"][0]["torques"], &half = weak_report["clips"][0]["torques"];
  ASSERT_FALSE(strong.empty());
  EXPECT_EQ(strong[0]["joint"], half[0]["joint"]);
  EXPECT_NEAR(half[0]["share"].get<double>(), 2 * strong[0]["share"].get<double>(), 1e-6);
  EXPECT_EQ(out.skeleton.joints, weak.skeleton.joints);  // muscles stay as they are
}

TEST(Retarget, KeepsTheTargetsOwnClipsWhenAsked) {
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  options.keep_clips = true;
  ASSERT_FALSE(retarget_clips(mannequin(), mannequin(0.9), options, out, report));
  EXPECT_EQ(out.clips.size(), mannequin().clips.size() + 1);
  EXPECT_GE(out.find_clip("walk_2"), 0);
}

TEST(Retarget, AMapNamesWhatNamesDoNotSay) {
  Asset nameless = mannequin();
  nlohmann::json map = {{"to", nlohmann::json::object()}};
  const char* const roles[] = {"thigh_l", "shin_l", "foot_l", "thigh_r", "shin_r", "foot_r"};
  for (const char* role : roles) map["to"][role] = role;  // the mannequin's joints have these names
  for (Joint& joint : nameless.skeleton.joints) joint.role = Role::kNone;
  Asset out;
  nlohmann::json report;
  Options options;
  options.clips = {"walk"};
  EXPECT_TRUE(retarget_clips(mannequin(), nameless, options, out, report));
  ASSERT_FALSE(options.read_map(map));
  const Error error = retarget_clips(mannequin(), nameless, options, out, report);
  ASSERT_FALSE(error) << error.message;
  expect_stands(report["clips"][0], "walk");
  EXPECT_EQ(report["chains"].size(), 7u);         // pelvis and legs
  EXPECT_EQ(report["other_joints"].size(), 15u);  // arms, trunk, head and toes follow by their names
}

std::string refusal(const Asset& source, const Asset& target, const Options& options = {}) {
  Asset out;
  nlohmann::json report;
  return retarget_clips(source, target, options, out, report).message;
}

TEST(Retarget, NamesWhatIsWrong) {
  Options options;
  options.clips = {"swim"};
  EXPECT_EQ(refusal(mannequin(), mannequin(), options), "the source has no clip 'swim'");
  Asset bare = mannequin();
  bare.clips.clear();
  EXPECT_EQ(refusal(bare, mannequin()), "the source has no clips");
  Options map;
  EXPECT_NE(map.read_map({{"form", 1}}).message.find("'form'"), std::string::npos);
  EXPECT_NE(map.read_map({{"to", {{"thigh_l", 3}}}}).message.find("thigh_l"), std::string::npos);
  ASSERT_FALSE(map.read_map({{"to", {{"thigh_l", "wing"}}}}));
  EXPECT_EQ(refusal(mannequin(), mannequin(), map), "the map, 'to': it has no joint 'wing'");
  Options tail;
  ASSERT_FALSE(tail.read_map({{"from", {{"tail", "head"}}}}));
  EXPECT_EQ(refusal(mannequin(), mannequin(), tail), "the map, 'from': there is no role 'tail'");
  Asset broken = mannequin();
  broken.clips[0].groups[0].controls[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal(broken, mannequin()).find("'" + broken.clips[0].name + "'"), std::string::npos);
  Asset flat = mannequin();
  for (Joint& joint : flat.skeleton.joints) joint.rest.translation.setZero();
  EXPECT_NE(refusal(mannequin(), flat).find("the target: its legs have no length"), std::string::npos);
}

}  // namespace
}  // namespace sinew::retarget::test
