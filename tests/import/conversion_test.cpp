// Traps that show only when a file is converted: units, axes, control bones, mesh and clips in several files.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "reading.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/io/asset.h"
#include "sinew/skeleton/skeleton.h"
#include "skinned_leg.h"

namespace sinew::convert {
namespace {

namespace fs = std::filesystem;
using import::test::Scratch;

struct Converted {
  Asset asset;
  std::string error;
  double unit = 0, height = 0;  ///< m
  std::string unit_from, up, name;
  std::vector<std::string> notes;
};

Converted convert(const std::vector<std::string>& inputs, const nlohmann::json& options = {}) {
  Converted made;
  nlohmann::json report;
  made.error = convert_files(inputs, options, made.asset, report).message;
  if (!made.error.empty()) return made;
  made.name = report["name"];
  made.notes = report["notes"].get<std::vector<std::string>>();
  if (!report.contains("unit")) return made;  // a URDF's is known
  made.unit = report["unit"]["meters_per_unit"];
  made.unit_from = report["unit"]["from"];
  made.up = report["up"]["axis"];
  made.height = report["height_m"];
  return made;
}

MATCHER_P(NotesSay, text, "") {
  return testing::ExplainMatchResult(testing::Contains(testing::HasSubstr(text)), arg.notes, result_listener);
}

class SharedAsset : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(root_)) GTEST_SKIP() << root_ << " is not there";
  }
  Converted convert_shared(const std::vector<std::string>& names, const nlohmann::json& options = {}) const {
    std::vector<std::string> inputs;
    inputs.reserve(names.size());
    for (const std::string& name : names) inputs.push_back((root_ / name).string());
    Converted made = convert(inputs, options);
    EXPECT_EQ(made.error, "");
    return made;
  }
  const fs::path root_ = fs::path(shared_dir()) / "assets";
};

constexpr double kCmuUnit = 0.056444;  ///< m, by the library's own notes

TEST_F(SharedAsset, ClipsOfOneLibraryGetOneUnit) {  // traps 1 and 4: three BVH, and FBX that say centimetres
  for (const char* name : {"bvh/cmu_12_01_walk.bvh", "bvh/cmu_01_01_jumps.bvh", "bvh/cmu_13_26.bvh"})
    EXPECT_EQ(convert_shared({name}).unit, kCmuUnit) << name;
  for (const char* name :
       {"fbx/cmu_49_08_cartwheel.fbx", "fbx/cmu_09_11_run.fbx"})  // under a node scaled by 100
    EXPECT_DOUBLE_EQ(convert_shared({name}).unit, kCmuUnit / 100) << name;
}

TEST_F(SharedAsset, WhatOnlyCarriesTheFigureIsNoPartOfIt) {
  const Converted runner = convert_shared({"fbx/cmu_09_11_run.fbx"});
  EXPECT_EQ(runner.asset.skeleton.joints[0].name, "Hips");
  EXPECT_THAT(runner, NotesSay("'09_11' only carries the figure about; left out"));
}

TEST_F(SharedAsset, FoxInCentimetresIsAFox) {  // trap 1: glTF means metres, the file has 79 of them
  const Converted fox = convert_shared({"gltf/fox.glb"});
  EXPECT_EQ(fox.unit, 0.01);
  EXPECT_NEAR(fox.height, 0.79, 0.01);  // to the tips of the ears; its joints span 0.61
}

TEST_F(SharedAsset, LargeCharacterInMetresStaysLarge) {
  EXPECT_EQ(convert_shared({"gltf/quaternius_robot.glb"}).unit, 1);
}

TEST_F(SharedAsset, OptionBeatsFileAndGuess) {
  EXPECT_EQ(convert_shared({"bvh/cmu_12_01_walk.bvh"}, {{"unit", 0.05}}).unit, 0.05);
  EXPECT_EQ(convert_shared({"gltf/cesium_man.gltf"}, {{"unit", 1.5}}).unit, 1.5);
}

TEST_F(SharedAsset, UpAxisComesFromTheFirstFrame) {  // trap 2
  EXPECT_EQ(convert_shared({"bvh/fair_jumping.bvh"}).up, "z");
  EXPECT_EQ(convert_shared({"bvh/cmu_12_01_walk.bvh"}).up, "y");
}

TEST_F(SharedAsset,
       StarOfBonesAtRestIsMeasuredWhereItStands) {  // trap 3: 20 units high at rest, 154 in frame 0
  const Converted dancer = convert_shared({"bvh/jesse_dance.bvh"});
  EXPECT_EQ(dancer.unit, 0.01);
  EXPECT_GT(dancer.height, 1.4);
}

TEST_F(SharedAsset, ControlBonesGetNoBody) {  // trap 12
  const Converted knight = convert_shared({"gltf/kaykit_knight.glb"});
  for (int j = 0; j < knight.asset.skeleton.body_count; ++j) {
    const std::string& name = knight.asset.skeleton.joints[static_cast<std::size_t>(j)].name;
    EXPECT_EQ(name.find("IK"), std::string::npos) << name;
    EXPECT_EQ(name.find("slot"), std::string::npos) << name;
    EXPECT_EQ(name.find("control"), std::string::npos) << name;
  }
}

TEST_F(SharedAsset, MeshAndClipsMayComeFromTwoFiles) {  // traps 15 and 16
  const Converted manny =
      convert_shared({"gltf/kaykit_manny/manny_med_mod.gltf", "gltf/kaykit_manny/Med_MovementBasic.glb"});
  EXPECT_EQ(manny.asset.clips.size(), 11u);
  EXPECT_FALSE(manny.asset.meshes.empty());
}

/// kicking_leg() with a shin below, which leaves the leg along `shin`; all three joints turn.
std::string leg_with_shin(const std::vector<double>& shin, const char* clip) {
  nlohmann::json gltf = import::test::kicking_leg();
  gltf["nodes"][1]["children"] = {2};
  gltf["nodes"].push_back({{"name", "shin"}, {"translation", shin}});
  nlohmann::json& animation = gltf["animations"][0];
  animation["name"] = clip;
  for (const int node : {0, 2}) {
    animation["channels"].push_back(animation["channels"][0]);
    animation["channels"].back()["target"]["node"] = node;
  }
  return gltf.dump();
}

TEST(SeveralFiles, ClipsOfAnotherSkeletonAreRefusedAndNeverTwistTheCharacter) {
  const Scratch scratch;
  const std::string first = scratch.write("first.gltf", leg_with_shin({0, -0.4, 0}, "kick")).string(),
                    same = scratch.write("same.gltf", leg_with_shin({0, -0.5, 0.02}, "hop")).string(),
                    other = scratch.write("other.gltf", leg_with_shin({0.4, 0, 0}, "hop")).string();
  const Converted made = convert({first, same});
  EXPECT_EQ(made.error, "");
  EXPECT_EQ(made.asset.clips.size(), 2u);
  EXPECT_THAT(convert({first, other}).error,
              testing::HasSubstr("for another skeleton: from 'leg' to 'shin' its bone goes 90 degrees off"));
}

/// A leg with a foot in metres and Y up, whose joints' frames have Z up, as Blender writes them.
std::string leg_of_blender() {
  nlohmann::json gltf = import::test::kicking_leg();
  gltf["nodes"] = nlohmann::json::parse(R"([
    {"name": "hip", "children": [1], "translation": [0, 1, 0], "rotation": [-0.70710678, 0, 0, 0.70710678]},
    {"name": "leg", "children": [2]},
    {"name": "foot", "children": [3], "translation": [0, 0, -0.5]},
    {"name": "toes", "translation": [0, -0.2, 0]}])");
  nlohmann::json& animation = gltf["animations"][0];
  for (const int node : {2, 3}) {
    animation["channels"].push_back(animation["channels"][0]);
    animation["channels"].back()["target"]["node"] = node;
  }
  return gltf.dump();
}

/// The same leg in centimetres and Z up. It lies in the first frame and stands in the second, or stays lying.
std::string lying_leg_bvh(const std::string& leg = "leg", bool stays = false) {
  const std::string turned = "0 0 0 0 90 0 0 0 0 0 0 0\n", at_rest = "0 0 0 0 0 0 0 0 0 0 0 0\n";
  return "HIERARCHY\nROOT " + leg +
         "\n{\n  OFFSET 0 0 0\n"
         "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
         "  JOINT foot\n  {\n    OFFSET 0 0 -50\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
         "    JOINT toes\n    {\n      OFFSET 0 -20 0\n      CHANNELS 3 Zrotation Xrotation Yrotation\n"
         "      End Site\n      {\n        OFFSET 0 -5 0\n      }\n    }\n  }\n}\n"
         "MOTION\nFrames: 2\nFrame Time: 0.1\n" +
         turned + (stays ? turned : at_rest);
}

TEST(SeveralFiles, UnitAndAxesOfClipsAreFoundByTheBonesOfTheCharacter) {
  const Scratch scratch;
  const std::string leg = scratch.write("leg.gltf", leg_of_blender()).string();
  const std::string lying = scratch.write("lying.bvh", lying_leg_bvh()).string();
  const Converted made = convert({leg, lying});
  ASSERT_EQ(made.error, "");
  EXPECT_THAT(made, NotesSay("'lying': unit 0.01 m (by its bones' lengths), up z (by its bones at rest)"));
  const Clip& clip = made.asset.clips.back();
  std::vector<Transform<double>> pose(made.asset.skeleton.joints.size());
  ASSERT_TRUE((SamplingJob<double>{&clip, clip.duration, {}, pose}.Run().ok()));
  for (std::size_t j = 0; j < pose.size(); ++j) {  // at rest, where it faces x as the character does
    const Transform<double>& rest = made.asset.skeleton.joints[j].rest;
    EXPECT_LT(pose[j].rotation.angularDistance(rest.rotation), 0.01) << made.asset.skeleton.joints[j].name;
    if (j > 0) {  // the root travels
      EXPECT_LT((pose[j].translation - rest.translation).norm(), 1e-3);
    }
  }
}

TEST(SeveralFiles, OptionsHoldForAddedFilesToo) {
  const Scratch scratch;
  const std::string leg = scratch.write("leg.bvh", lying_leg_bvh()).string();
  const std::string more = scratch.write("more.bvh", lying_leg_bvh("leg", true)).string();
  EXPECT_THAT(convert({leg, more}, {{"unit", 0.02}, {"up", "z"}}),
              NotesSay("'more': unit 0.02 m (option), up z (option)"));
}

TEST(SeveralFiles, BonesOfOtherProportionsAreSaid) {
  const Scratch scratch;
  const std::string leg = scratch.write("leg.gltf", leg_of_blender()).string();
  std::string bvh = lying_leg_bvh();
  bvh.replace(bvh.find("-50"), 3, "-30");
  const Converted made = convert({leg, scratch.write("short.bvh", bvh).string()});
  EXPECT_THAT(made,
              NotesSay("'short': its bones do not agree on its unit: half of them say 0.01 to 0.0167 m"));
}

TEST(SeveralFiles, ClipsThatShareNoJointAreRefused) {
  const Scratch scratch;
  const std::string leg = scratch.write("leg.bvh", lying_leg_bvh()).string();
  std::string bvh = import::test::walking_bvh();
  bvh.replace(bvh.find("leg"), 3, "arm");
  const std::string arm = scratch.write("arm.bvh", bvh).string();
  const std::string error = convert({leg, arm}).error;
  EXPECT_EQ(error.rfind(arm + ": ", 0), 0u) << error;
  EXPECT_THAT(error, testing::HasSubstr("shares no joint name with 'leg'"));
}

TEST(SeveralFiles, WhatCannotBeUsedIsAnErrorAndNotLeftOut) {
  const Scratch scratch;
  const std::string leg = scratch.write("leg.gltf", import::test::skinned({1, 0, 0, 0}, {0}).dump()).string();
  const std::string robot = scratch
                                .write("robot.urdf", R"(<robot name="r"><link name="hip"/><link name="leg"/>
        <joint name="j" type="fixed"><parent link="hip"/><child link="leg"/></joint></robot>)")
                                .string();
  EXPECT_THAT(convert({leg, robot}).error, testing::HasSubstr("a URDF takes no part in other characters"));
  nlohmann::json still = import::test::kicking_leg();
  still.erase("animations");
  EXPECT_THAT(convert({leg, scratch.write("still.gltf", still.dump()).string()}).error,
              testing::HasSubstr("'still' cannot be added: it has no joints"));
}

TEST_F(SharedAsset, FiguresOfASizeThatNoHumanHasAreNoted) {
  EXPECT_THAT(convert_shared({"gltf/quaternius_robot.glb"}), NotesSay("no human is 4.56 m tall"));
  const Converted knight = convert_shared({"gltf/kaykit_knight.glb"}, {{"clips", {"Idle"}}});
  EXPECT_THAT(knight, testing::Not(NotesSay("no human")));
  EXPECT_THAT(convert_shared({"gltf/kaykit_knight.glb"}, {{"clips", {"Idle"}}, {"total_mass", 900}}),
              NotesSay("no human of 2.47 m weighs 900.0 kg"));
}

TEST_F(SharedAsset, RigidPartsWithoutSkinMakeACharacter) {  // trap 14
  const Converted character = convert_shared({"gltf/kenney_character.glb"});
  EXPECT_GE(character.asset.skeleton.body_count, 6);
  EXPECT_EQ(character.asset.clips.size(), 4u);
}

TEST_F(SharedAsset, WeightsAreRepairedAndItIsSaid) {  // traps 27 and 28
  const Converted geno = convert_shared({"fbx/geno.fbx"});
  EXPECT_THAT(geno, NotesSay("weights that do not sum to 1"));
  EXPECT_THAT(geno, NotesSay("more than four influences"));
  EXPECT_THAT(geno, NotesSay("FBX pivot nodes folded"));
  for (const auto& mesh : geno.asset.meshes)
    for (std::size_t v = 0; v < mesh.weights.size(); v += 4) {
      const float sum = mesh.weights[v] + mesh.weights[v + 1] + mesh.weights[v + 2] + mesh.weights[v + 3];
      ASSERT_NEAR(sum, 1, 1e-6);  // four floats added
    }
}

TEST_F(SharedAsset, WhatIsOddInAUrdfIsSaid) {
  const Converted romeo = convert_shared({"urdf/romeo.urdf"});
  EXPECT_THAT(romeo, NotesSay("inertia that no body can have"));  // trap 39
  EXPECT_THAT(romeo, NotesSay("mimics"));                         // trap 44
  EXPECT_THAT(romeo, NotesSay("moves no mass"));                  // trap 38
  const Converted panda = convert_shared({"urdf/panda.urdf"});
  EXPECT_THAT(panda, NotesSay("zero is outside its limits"));  // trap 42
  EXPECT_THAT(panda, NotesSay("links have meshes only"));      // trap 49
  const Converted quadruped = convert_shared({"urdf/bullet_quadruped.urdf"});
  EXPECT_THAT(quadruped, NotesSay("is locked"));  // trap 43
  const Converted humanoid = convert_shared({"urdf/bullet_humanoid.urdf"});
  EXPECT_THAT(humanoid, NotesSay("urdfdom: "));        // trap 47: its capsules
  EXPECT_THAT(humanoid, NotesSay("no effort limit"));  // traps 40 and 41
  EXPECT_THAT(humanoid, NotesSay("axis of length"));   // trap 45
  EXPECT_TRUE(validate(humanoid.asset.skeleton).ok());
}

/// A foot with toes ahead of it along the source's x: Y up, so it faces Sinew's y as it stands.
std::string sideways_foot() {
  nlohmann::json gltf = import::test::skinned({0.5f, 0.5f, 0, 0}, {0});
  gltf["nodes"][0]["name"] = "foot_l";
  gltf["nodes"][1]["name"] = "toes_l";
  gltf["nodes"][1]["translation"] = {0.5, 0, 0};
  return gltf.dump();
}

TEST(Facing, IsFoundByTheToesOrGivenAndEndsAlongX) {
  const Scratch scratch;
  const std::string file = scratch.write("a.gltf", sideways_foot()).string();
  const auto toes = [](const Converted& made) {  // seen from the foot, along the model's axes
    const std::vector<Joint>& joints = made.asset.skeleton.joints;
    return Vec3<double>(joints[0].rest.rotation * joints[1].rest.translation);
  };
  const Converted found = convert({file});
  ASSERT_EQ(found.error, "");
  EXPECT_TRUE(toes(found).isApprox(Vec3<double>(0.5, 0, 0), 1e-6)) << toes(found).transpose();
  EXPECT_THAT(found, NotesSay("turned by -90 degrees about the vertical to face x, by its toes"));
  const Converted as_it_was = convert({file}, {{"facing", "z"}});
  EXPECT_TRUE(toes(as_it_was).isApprox(Vec3<double>(0, 0.5, 0), 1e-6)) << toes(as_it_was).transpose();
  const Converted back = convert({file}, {{"facing", "-x"}});
  EXPECT_TRUE(toes(back).isApprox(Vec3<double>(-0.5, 0, 0), 1e-6)) << toes(back).transpose();
  EXPECT_THAT(convert({file}, {{"facing", "up"}}).error,
              testing::HasSubstr("option 'facing' is not an axis"));
}

TEST(Conversion, FarPropDoesNotChangeTheUnit) {  // trap 34
  nlohmann::json gltf = import::test::kicking_leg();
  gltf["nodes"].push_back({{"name", "camera"}, {"translation", {1000, 0, 0}}});
  gltf["nodes"][0]["children"].push_back(2);
  gltf["animations"][0]["channels"].push_back(gltf["animations"][0]["channels"][0]);
  gltf["animations"][0]["channels"][1]["target"]["node"] = 0;
  const Scratch scratch;
  const Converted made = convert({scratch.write("a.gltf", gltf.dump()).string()});
  ASSERT_EQ(made.error, "");
  EXPECT_EQ(made.unit, 1);
  EXPECT_EQ(made.unit_from, "file");
}

using import::test::kick_keys;
using import::test::kicking_leg;
using import::test::set_buffer;
using import::test::skinned;

Converted convert_gltf(const nlohmann::json& gltf) {
  const Scratch scratch;
  Converted made = convert({scratch.write("a.gltf", gltf.dump()).string()});
  EXPECT_EQ(made.error, "");
  return made;
}

int joint_named(const Converted& made, const std::string& name) {
  const auto& joints = made.asset.skeleton.joints;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].name == name) return static_cast<int>(j);
  return -1;
}

TEST(Conversion, NodeBetweenTwoBonesBecomesAJoint) {  // trap 8
  nlohmann::json gltf = skinned({0.5f, 0.5f, 0, 0}, {0});
  const std::size_t between = gltf["nodes"].size();
  gltf["nodes"].push_back({{"name", "between"}, {"translation", {0, -0.25, 0}}, {"children", {1}}});
  gltf["nodes"][0]["children"] = {between};
  const Converted made = convert_gltf(gltf);
  const int joint = joint_named(made, "between");
  ASSERT_GE(joint, 0);
  EXPECT_EQ(made.asset.skeleton.joints[joint_named(made, "leg")].parent, joint);
  EXPECT_NEAR(made.asset.skeleton.joints[joint].rest.translation.norm(), 0.25, 1e-6);  // floats
}

TEST(Conversion, RigidPropFollowsTheJointItHangsOn) {  // trap 13
  nlohmann::json gltf = skinned({1, 0, 0, 0}, {0});
  gltf["meshes"].push_back(gltf["meshes"][0]);
  gltf["meshes"][1]["name"] = "hat";
  gltf["meshes"][1]["primitives"][0]["attributes"].erase("JOINTS_0");
  gltf["meshes"][1]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  gltf["nodes"].push_back({{"name", "hat"}, {"mesh", 1}});
  gltf["nodes"][1]["children"] = {gltf["nodes"].size() - 1};
  const Converted made = convert_gltf(gltf);
  const auto hat = std::find_if(made.asset.meshes.begin(), made.asset.meshes.end(),
                                [](const Mesh& m) { return m.name == "hat"; });
  ASSERT_NE(hat, made.asset.meshes.end());
  EXPECT_EQ(hat->joints[0], joint_named(made, "leg"));
  EXPECT_EQ(hat->weights[0], 1);
  EXPECT_NEAR(hat->positions[2], 0.5, 1e-6);  // the leg's place, in floats
}

TEST(Conversion, MeshThatHangsOnNoJointIsLeftOut) {  // trap 34
  nlohmann::json gltf = skinned({1, 0, 0, 0}, {0});
  gltf["meshes"].push_back(gltf["meshes"][0]);
  gltf["meshes"][1]["name"] = "floor";
  gltf["meshes"][1]["primitives"][0]["attributes"].erase("JOINTS_0");
  gltf["meshes"][1]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  gltf["nodes"].push_back({{"name", "floor"}, {"mesh", 1}, {"translation", {0, 13, 0}}});
  gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size() - 1);
  const Converted made = convert_gltf(gltf);
  EXPECT_EQ(made.asset.meshes.size(), 1u);
  EXPECT_LT(made.height, 3);
  EXPECT_THAT(made, NotesSay("mesh 'floor' hangs on no joint; left out"));
}

TEST(Conversion, SkinIsBakedWhereItsBindMatricesPutItAtRest) {      // trap 29
  const Converted made = convert_gltf(skinned({1, 0, 0, 0}, {1}));  // bound 1 m along X from where it rests
  ASSERT_EQ(made.asset.meshes.size(), 1u);
  const auto& at = made.asset.meshes[0].positions;  // of the corner at 0: hip (0, 1, 0) less (1, 0, 0), Y up
  EXPECT_NEAR(at[0], 0, 1e-6);                      // floats
  EXPECT_NEAR(at[1], -1, 1e-6);
  EXPECT_NEAR(at[2], 1, 1e-6);
}

TEST(Conversion, NegatedQuaternionIsTheSameKey) {  // trap 24
  nlohmann::json gltf = kicking_leg();
  const Converted plain = convert_gltf(gltf);
  std::vector<float> keys = kick_keys();
  for (std::size_t k = 7; k < 11; ++k) keys[k] = -keys[k];  // the second of three
  set_buffer(gltf, keys);
  EXPECT_EQ(write_asset(convert_gltf(gltf).asset), write_asset(plain.asset));
}

TEST(Conversion, BoneThatChangesItsLengthKeepsDoingSo) {  // trap 35
  nlohmann::json gltf = kicking_leg();
  std::vector<float> values = kick_keys();
  const std::size_t places =
      import::test::append(gltf, values, {0, -0.5f, 0, 0, -0.6f, 0, 0, -0.5f, 0}, "VEC3", 3);
  auto& kick = gltf["animations"][0];
  kick["channels"].push_back(kick["channels"][0]);
  kick["channels"][1]["target"]["node"] = 0;  // without a skin, a joint is what moves
  kick["samplers"].push_back({{"input", 0}, {"output", places}});
  kick["channels"].push_back({{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}});
  set_buffer(gltf, values);
  const Converted made = convert_gltf(gltf);
  ASSERT_EQ(made.asset.clips.size(), 1u);
  std::vector<JointJet<float>> jets(made.asset.skeleton.joints.size());
  ASSERT_TRUE((SamplingJob<float>{&made.asset.clips[0], 0.5, jets}.Run().ok()));
  const auto leg = static_cast<std::size_t>(joint_named(made, "leg"));
  EXPECT_NEAR(jets[leg].translation.norm(), 0.6, 1.1e-3);  // the curve's budget is 1 mm
  EXPECT_THAT(made, NotesSay("1 joint changes its distance to the parent, by up to 100 mm"));
}

/// kicking_leg() with these keys: s, rad about X.
nlohmann::json leg_turned_by(const std::vector<std::pair<double, double>>& keys) {
  nlohmann::json gltf = kicking_leg();
  std::vector<float> values;
  for (const auto& key : keys) values.push_back(static_cast<float>(key.first));
  for (const auto& key : keys)
    for (const double x : {std::sin(key.second / 2), 0.0, 0.0, std::cos(key.second / 2)})
      values.push_back(static_cast<float>(x));
  for (std::size_t a = 0; a < 2; ++a) {
    const std::size_t numbers = keys.size() * (a == 0 ? 1 : 4);
    gltf["accessors"][a]["count"] = keys.size();
    gltf["bufferViews"][a]["byteOffset"] = a == 0 ? 0 : keys.size() * sizeof(float);
    gltf["bufferViews"][a]["byteLength"] = numbers * sizeof(float);
  }
  gltf["accessors"][0]["max"] = {keys.back().first};
  set_buffer(gltf, values);
  return gltf;
}

/// Still for a second at 30 keys/s, but for `more`.
std::vector<std::pair<double, double>> still_but_for(const std::vector<std::pair<double, double>>& more) {
  std::vector<std::pair<double, double>> keys = more;
  for (int k = 0; k <= 30; ++k) keys.emplace_back(k / 30.0, 0);
  std::sort(keys.begin(), keys.end());
  return keys;
}

TEST(Conversion, KeysBetweenEvenSamplesAreFollowed) {  // trap 20
  for (const double between : {0.5, 0.37}) {           // of the time between two keys
    const double t = (15 + between) / 30, angle = 1.5;
    const Converted made = convert_gltf(leg_turned_by(still_but_for({{t, angle}})));
    ASSERT_EQ(made.asset.clips.size(), 1u);
    const auto rotation_at = [&](double time) {
      std::vector<Transform<double>> pose(made.asset.skeleton.joints.size());
      EXPECT_TRUE((SamplingJob<double>{&made.asset.clips[0], time, {}, pose}.Run().ok()));
      return pose[0].rotation;
    };
    EXPECT_NEAR(rotation_at(0).angularDistance(rotation_at(t)), angle, 0.01);  // 1 mm at 10 cm
    EXPECT_FALSE(testing::Value(made, NotesSay("off by")));
  }
}

TEST(Conversion, KeysTooCloseToFollowAreSaid) {  // a step between two samples
  std::vector<std::pair<double, double>> keys;
  for (int k = 0; k <= 30; ++k) keys.emplace_back(k / 30.0, k <= 15 ? 0 : 1.5);
  keys.insert(keys.begin() + 16, {0.501, 1.5});
  EXPECT_THAT(convert_gltf(leg_turned_by(keys)),
              NotesSay("keys less than 1/120 s from others are left out; joint 'leg' passes one by"));
}

TEST(Conversion, ErrorsBeyondWhatWasAskedForAreSaid) {
  const Scratch scratch;
  const std::string file = scratch.write("a.gltf", kicking_leg().dump()).string();
  EXPECT_FALSE(testing::Value(convert({file}), NotesSay("asked for")));
  const Converted made = convert({file}, {{"fit_error_mm", 1e-4}});  // less than numbers of 16 bits can hold
  EXPECT_THAT(made, NotesSay("clip 'kick': joint 'leg' is off by"));
  EXPECT_THAT(made, NotesSay("more than the 0.0001 mm asked for"));
}

TEST(Conversion, NamesInMessagesAreThoseOfTheFile) {
  const Scratch scratch;
  const std::string file = scratch.write("Läufer 1.bvh", "HIERARCHY").string();
  const Converted made = convert({file});
  EXPECT_EQ(made.error.rfind(file + ": ", 0), 0u) << made.error;
}

TEST(Conversion, NamesInLatin1BecomeUtf8) {
  std::string bvh = import::test::walking_bvh();
  bvh.replace(bvh.find("hip"), 3,
              "H\xFC"
              "fte");
  const Scratch scratch;
  const Converted made = convert({scratch.write("l\xE4uft.bvh", bvh).string()});
  ASSERT_EQ(made.error, "");
  EXPECT_EQ(made.name, "läuft");
  EXPECT_EQ(made.asset.skeleton.joints[0].name, "Hüfte");
}

TEST(Conversion, WhatLeavesTheSpaceOfFloatsIsRefused) {
  const Scratch scratch;
  const std::string file = scratch.write("a.bvh", import::test::walking_bvh()).string();
  for (const double unit : {1e300, std::nan(""), -1.0})
    EXPECT_THAT(convert({file}, {{"unit", unit}}).error, testing::HasSubstr("option 'unit'"));
  EXPECT_THAT(convert({file}, {{"unit", 1e5}}).error, testing::HasSubstr("10 km from the origin"));
  const std::string far =
      scratch
          .write("b.bvh", import::test::short_bvh("Frames: 2\nFrame Time: 0.02\n0 90 0 0 0 0 0 0 "
                                                  "0\n1e30 90 0 0 0 0 0 90 0\n"))
          .string();
  EXPECT_THAT(convert({far}).error, testing::HasSubstr("clip 'Motion'"));
  nlohmann::json gltf = kicking_leg();
  set_buffer(gltf, {0, 0.5f, 1e8f, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  gltf["accessors"][0]["max"] = {1e8};
  EXPECT_THAT(convert({scratch.write("c.gltf", gltf.dump()).string()}).error,
              testing::HasSubstr("clip 'kick' is too long"));
}

TEST(Conversion, SceneWithoutJointsIsRefusedInWords) {  // trap 37
  const Scratch scratch;
  const std::string file = scratch
                               .write("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
                                                     "scenes": [{"nodes": [0]}], "nodes": [{}]})")
                               .string();
  EXPECT_NE(convert({file}).error.find("no joints"), std::string::npos);
}

}  // namespace
}  // namespace sinew::convert
