// Traps that show only when a file is converted: units, axes, control bones, mesh and clips in several files.
#include <gmock/gmock.h>

#include "convert/convert.h"
#include "reading.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {
namespace {

namespace fs = std::filesystem;
using import::test::Scratch;

struct Converted {
  Asset asset;
  nlohmann::json report;
  std::string error;
  double unit() const { return report["unit"]["meters_per_unit"]; }
  double height() const { return report["height_m"]; }
};

Converted convert(const std::vector<std::string>& inputs, const nlohmann::json& options = {}) {
  Converted made;
  made.error = convert_files(inputs, options, made.asset, made.report).message;
  return made;
}

MATCHER_P(NotesSay, text, "") {
  *result_listener << arg.report["notes"].dump();
  for (const auto& note : arg.report["notes"])
    if (note.template get<std::string>().find(text) != std::string::npos) return true;
  return false;
}

class SharedAsset : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(root_)) GTEST_SKIP() << root_ << " is not there";
  }
  Converted convert_shared(const std::vector<std::string>& names, const nlohmann::json& options = {}) const {
    std::vector<std::string> inputs;
    for (const std::string& name : names) inputs.push_back((root_ / name).string());
    Converted made = convert(inputs, options);
    EXPECT_EQ(made.error, "");
    return made;
  }
  const fs::path root_ = fs::path(SINEW_SHARED_DIR) / "assets";
};

constexpr double kCmuUnit = 0.056444;  ///< m, by the library's own notes

TEST_F(SharedAsset, ClipsOfOneLibraryGetOneUnit) {  // traps 1 and 4: three BVH, and FBX that say centimetres
  for (const char* name : {"bvh/cmu_12_01_walk.bvh", "bvh/cmu_01_01_jumps.bvh", "bvh/cmu_13_26.bvh"})
    EXPECT_EQ(convert_shared({name}).unit(), kCmuUnit) << name;
  for (const char* name :
       {"fbx/cmu_49_08_cartwheel.fbx", "fbx/cmu_09_11_run.fbx"})  // under a node scaled by 100
    EXPECT_DOUBLE_EQ(convert_shared({name}).unit(), kCmuUnit / 100) << name;
}

TEST_F(SharedAsset, FoxInCentimetresIsAFox) {  // trap 1: glTF means metres, the file has 79 of them
  const Converted fox = convert_shared({"gltf/fox.glb"});
  EXPECT_EQ(fox.unit(), 0.01);
  EXPECT_NEAR(fox.height(), 0.79, 0.01);  // to the tips of the ears; its joints span 0.61
}

TEST_F(SharedAsset, LargeCharacterInMetresStaysLarge) {
  EXPECT_EQ(convert_shared({"gltf/quaternius_robot.glb"}).unit(), 1);
}

TEST_F(SharedAsset, OptionBeatsFileAndGuess) {
  EXPECT_EQ(convert_shared({"bvh/cmu_12_01_walk.bvh"}, {{"unit", 0.05}}).unit(), 0.05);
  EXPECT_EQ(convert_shared({"gltf/cesium_man.gltf"}, {{"unit", 1.5}}).unit(), 1.5);
}

TEST_F(SharedAsset, UpAxisComesFromTheFirstFrame) {  // trap 2
  EXPECT_EQ(convert_shared({"bvh/fair_jumping.bvh"}).report["up"]["axis"], "z");
  EXPECT_EQ(convert_shared({"bvh/cmu_12_01_walk.bvh"}).report["up"]["axis"], "y");
}

TEST_F(SharedAsset,
       StarOfBonesAtRestIsMeasuredWhereItStands) {  // trap 3: 20 units high at rest, 154 in frame 0
  const Converted dancer = convert_shared({"bvh/jesse_dance.bvh"});
  EXPECT_EQ(dancer.unit(), 0.01);
  EXPECT_GT(dancer.height(), 1.4);
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
  const Converted quadruped = convert_shared({"urdf/bullet_quadruped.urdf"});
  EXPECT_THAT(quadruped, NotesSay("is locked"));  // trap 43
  const Converted humanoid = convert_shared({"urdf/bullet_humanoid.urdf"});
  EXPECT_THAT(humanoid, NotesSay("urdfdom: "));        // trap 47: its capsules
  EXPECT_THAT(humanoid, NotesSay("no effort limit"));  // traps 40 and 41
  EXPECT_THAT(humanoid, NotesSay("axis of length"));   // trap 45
  EXPECT_TRUE(validate(humanoid.asset.skeleton).ok());
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
  EXPECT_EQ(made.unit(), 1);
  EXPECT_EQ(made.report["unit"]["from"], "file");
}

TEST(Conversion, NamesInMessagesAreThoseOfTheFile) {
  const Scratch scratch;
  const std::string file = scratch.write("Läufer 1.bvh", "HIERARCHY").string();
  const Converted made = convert({file});
  EXPECT_EQ(made.error.rfind(file + ": ", 0), 0u) << made.error;
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
