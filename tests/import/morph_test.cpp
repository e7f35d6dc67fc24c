// Morph targets come out as they stand in the file, and convert to targets of the asset that curves move.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "convert/convert.h"
#include "convert/report_text.h"
#include "morphing_leg.h"
#include "sinew/animation/curve_job.h"

namespace sinew::import::test {
namespace {

using Json = nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Morph, TargetsComeWithTheirNamesWeightsAndKeys) {
  const Outcome outcome = read_content("a.gltf", morphing_leg().dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.meshes.size(), 1u);
  const std::vector<SourceMesh::Morph>& morphs = outcome.scene.meshes[0].morphs;
  ASSERT_EQ(morphs.size(), 2u);
  EXPECT_EQ(morphs[0].name, "smile");
  EXPECT_EQ(morphs[1].name, "frown");
  EXPECT_EQ(morphs[0].weight, 0.25f);
  EXPECT_EQ(morphs[1].weight, 0);
  ASSERT_EQ(morphs[0].moves.size(), 3u);
  EXPECT_THAT(morphs[0].moves[1], ElementsAre(0, FloatEq(0.25f), 0));
  EXPECT_THAT(morphs[1].moves[2], ElementsAre(0, 0, FloatEq(0.5f)));
  ASSERT_EQ(outcome.scene.clips.size(), 1u);
  ASSERT_EQ(outcome.scene.clips[0].morphs.size(), 1u);
  const SourceMorphChannel& channel = outcome.scene.clips[0].morphs[0];
  EXPECT_EQ(channel.mesh, 0);
  EXPECT_THAT(channel.times, ElementsAre(0, 0.5, 1));
  EXPECT_EQ(channel.weights, Morphing{}.keys);
}

TEST(Morph, ANodesOwnWeightsGoBeforeThoseOfItsMesh) {
  nlohmann::json gltf = morphing_leg();
  gltf["nodes"].push_back(gltf["nodes"][2]);  // first with the weights of the mesh, then with its own
  gltf["nodes"][3]["weights"] = {0.75, 0.5};
  gltf["scenes"][0]["nodes"].push_back(3);
  for (const bool own_first : {false, true}) {
    if (own_first) std::swap(gltf["nodes"][2], gltf["nodes"][3]);
    const Outcome outcome = read_content("a.gltf", gltf.dump());
    ASSERT_TRUE(outcome.ok) << outcome.error;
    ASSERT_EQ(outcome.scene.meshes.size(), 2u);
    const SourceMesh &own = outcome.scene.meshes[own_first ? 0 : 1],
                     &plain = outcome.scene.meshes[own_first ? 1 : 0];
    EXPECT_EQ(own.morphs[0].weight, 0.75f);
    EXPECT_EQ(own.morphs[1].weight, 0.5f);
    EXPECT_EQ(plain.morphs[0].weight, 0.25f);
    EXPECT_EQ(plain.morphs[1].weight, 0);
  }
}

TEST(Morph, CubicKeysAreTheirValuesWithoutTheTangents) {
  Morphing with;
  with.interpolation = "CUBICSPLINE";
  with.keys.clear();
  const std::vector<float> values = Morphing{}.keys;
  for (std::size_t k = 0; k < values.size(); k += 2)
    with.keys.insert(with.keys.end(), {7, 8, values[k], values[k + 1], 9, 10});
  const Outcome outcome = read_content("a.gltf", morphing_leg(with).dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.clips.at(0).morphs.at(0).weights, values);
}

TEST(Morph, DamagedOnesAreRefusedWithAReason) {
  const auto error = [](const Morphing& with) {
    return read_content("a.gltf", morphing_leg(with).dump()).error;
  };
  Morphing with;
  with.keys.pop_back();
  EXPECT_EQ(error(with), "animation 0: key times and values differ in number");
  with.keys = {0, kNan, 0, 0, 0, 0};
  EXPECT_THAT(error(with), HasSubstr("a weight of mesh 'skin0' is not finite"));
  with = {};
  with.frown[4] = kNan;
  EXPECT_THAT(error(with), HasSubstr("morph target 'frown' that is not finite"));
  with.frown[4] = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error(with), HasSubstr("morph target 'frown' that is not finite"));
}

TEST(Morph, MalformedOnesAreRefusedOrDoNothing) {
  const auto spoilt = [](const auto& spoil) {
    Json gltf = morphing_leg();
    spoil(gltf);
    const Outcome outcome = read_content("a.gltf", gltf.dump());
    EXPECT_EQ(outcome.error.find('\n'), std::string::npos) << outcome.error;
    EXPECT_EQ(outcome.ok, outcome.error.empty());
    return outcome;
  };
  const auto targets = [](Json& gltf) -> Json& { return gltf["meshes"][0]["primitives"][0]["targets"]; };
  EXPECT_FALSE(spoilt([&](Json& g) { targets(g)[0]["POSITION"] = 99; }).ok);
  EXPECT_FALSE(spoilt([&](Json& g) { targets(g).erase(1); }).ok);  // keys are for two
  EXPECT_FALSE(spoilt([](Json& g) { g["accessors"][0]["count"] = 0; }).ok);
  spoilt([&](Json& g) { targets(g) = "many"; });
  spoilt([&](Json& g) { targets(g)[0] = Json::object(); });
  spoilt([](Json& g) { g["meshes"][0]["weights"] = {1}; });
  spoilt([](Json& g) { g["meshes"][0]["extras"]["targetNames"] = {7}; });
  spoilt([&](Json& g) {  // of another number of vertices
    const std::size_t accessor = targets(g)[0]["POSITION"];
    g["accessors"][accessor]["count"] = 2;
  });
  const Outcome elsewhere = spoilt([](Json& g) { g["animations"][0]["channels"][1]["target"]["node"] = 0; });
  ASSERT_TRUE(elsewhere.ok) << elsewhere.error;
  EXPECT_TRUE(elsewhere.scene.clips[0].morphs.empty());
  EXPECT_THAT(elsewhere.scene.notes, Contains(HasSubstr("moves morph targets of")));
}

}  // namespace

/// A triangle "head" on a node "face", with two shapes of FBX's kind: "smile" goes to 1 within a second by
/// two keys, "frown" to a half and back by three.
static std::string fbx_face() {
  std::string shapes, links;
  const auto add = [&](int id, const std::string& name, const std::string& vertex, const std::string& move,
                       const std::string& times, const std::string& values, int keys) {
    const auto as = [&](int kind) { return std::to_string(10 * kind + id); };
    const std::string count = std::to_string(keys);
    shapes += "Geometry: " + as(1) + ", \"Geometry::" + name + "\", \"Shape\" {\nIndexes: *1 { a: " + vertex +
              " }\nVertices: *3 { a: " + move + " }\nNormals: *3 { a: 0,0,0 }\n}\nDeformer: " + as(3) +
              ", \"SubDeformer::" + name +
              "\", \"BlendShapeChannel\" {\nDeformPercent: 0\nFullWeights: *1 { a: 100 }\n}\n"
              "AnimationCurveNode: " +
              as(5) + ", \"AnimCurveNode::DeformPercent\", \"\" {\n}\nAnimationCurve: " + as(6) +
              ", \"AnimCurve::\", \"\" {\nKeyTime: *" + count + " { a: " + times + " }\nKeyValueFloat: *" +
              count + " { a: " + values + " }\n}\n";
    links += "C: \"OO\"," + as(3) + ",30\nC: \"OO\"," + as(1) + "," + as(3) + "\nC: \"OO\"," + as(5) +
             ",41\nC: \"OP\"," + as(5) + "," + as(3) + ",\"DeformPercent\"\nC: \"OP\"," + as(6) + "," +
             as(5) + ",\"d|DeformPercent\"\n";
  };
  add(1, "smile", "1", "0,0.25,0", "0,46186158000", "0,100", 2);
  add(2, "frown", "2", "0,0,0.5", "0,23093079000,46186158000", "0,50,0", 3);
  return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
         "GlobalSettings:  {\nVersion: 1000\nProperties70:  {\n"
         "P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n"
         "P: \"FrontAxis\", \"int\", \"Integer\", \"\",2\nP: \"FrontAxisSign\", \"int\", \"Integer\", "
         "\"\",1\n"
         "P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\nP: \"CoordAxisSign\", \"int\", \"Integer\", "
         "\"\",1\n"
         "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",100\nP: \"TimeMode\", \"enum\", \"\", \"\",6\n"
         "}\n}\nObjects:  {\nGeometry: 10, \"Geometry::head\", \"Mesh\" {\n"
         "Vertices: *9 { a: 0,0,0,1,0,0,0,1,0 }\nPolygonVertexIndex: *3 { a: 0,1,-3 }\n}\n"
         "Model: 20, \"Model::face\", \"Mesh\" {\nVersion: 232\n}\n"
         "Deformer: 30, \"Deformer::\", \"BlendShape\" {\nVersion: 100\n}\n"
         "AnimationStack: 40, \"AnimStack::talk\", \"\" {\nProperties70:  {\n"
         "P: \"LocalStop\", \"KTime\", \"Time\", \"\",46186158000\n}\n}\n"
         "AnimationLayer: 41, \"AnimLayer::base\", \"\" {\n}\n" +
         shapes + "}\nConnections:  {\nC: \"OO\",10,20\nC: \"OO\",20,0\nC: \"OO\",30,10\nC: \"OO\",41,40\n" +
         links + "}\n";
}

namespace {

// assimp 5.2.5 says 1 of the weights at rest, and leaves targets out of keys that are not theirs.
TEST(Morph, OfFbxFilesAreOffAtRestAndMoveOnBetweenTheirOwnKeys) {
  const Outcome outcome = read_content("a.fbx", fbx_face());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.meshes.size(), 1u);
  const SourceMesh& mesh = outcome.scene.meshes[0];
  ASSERT_EQ(mesh.morphs.size(), 2u);
  EXPECT_EQ(mesh.morphs[0].name, "smile");
  EXPECT_THAT(mesh.morphs[0].moves[1], ElementsAre(0, FloatEq(0.25f), 0));
  for (const SourceMesh::Morph& morph : mesh.morphs) EXPECT_EQ(morph.weight, 0) << morph.name;
  ASSERT_EQ(outcome.scene.clips.size(), 1u);
  ASSERT_EQ(outcome.scene.clips[0].morphs.size(), 1u);
  EXPECT_THAT(outcome.scene.clips[0].morphs[0].times, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(outcome.scene.clips[0].morphs[0].weights, ElementsAre(0, 0, FloatEq(0.5f), 0.5f, 1, 0));
}

}  // namespace
}  // namespace sinew::import::test

namespace sinew::convert {
namespace {

using import::test::Morphing;
using import::test::morphing_leg;
using import::test::Scratch;
using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A file converted, and what may stand beside it.
struct Converted {
  Asset asset;
  json report;
  std::string error;

  explicit Converted(const std::string& content, const std::string& beside = "",
                     const char* name = "leg.gltf") {
    const Scratch scratch;
    const std::string file = scratch.write(name, content).string();
    if (!beside.empty()) scratch.write("leg.clips.json", beside);
    error = convert_files({file}, json::object(), asset, report).message;
    EXPECT_EQ(error, "");
    // What was made can be written, and comes back with its targets.
    Asset back;
    const Status status = read_asset(write_asset(asset), back);
    EXPECT_TRUE(status.ok()) << status.reason;
  }

  /// Of a curve in the first clip.
  double value(const char* name, double time) const {
    std::vector<TimeJet<double>> values(asset.curve_slots.size());
    EXPECT_TRUE(CurveJob<double>({&asset.clips.at(0), time, asset.curve_slots, values}).Run().ok());
    return values.at(static_cast<std::size_t>(asset.find_curve(name))).value;
  }
  double rest(const char* name) const {
    return double(asset.curve_slots.at(static_cast<std::size_t>(asset.find_curve(name))).rest);
  }
  /// Which curve moves a target.
  std::string curve(std::size_t mesh, std::size_t morph) const {
    const int slot = asset.meshes.at(mesh).morph_curves.at(morph);
    return asset.curve_slots.at(static_cast<std::size_t>(slot)).name;
  }
};

constexpr double kFit = 2e-3;  ///< of a curve's range: what the converter's fit may be off
/// Straight lines are rounded at their keys, by as much as they turn within a knot of 3 ms.
constexpr double kRounded = 0.01;

/// Where a vertex of a mesh is at given weights.
std::vector<float> morphed(const Mesh& mesh, std::vector<float> weights) {
  std::vector<float> out(mesh.positions.size()), normals(mesh.normals.size());
  EXPECT_TRUE(MorphJob({mesh.positions, mesh.normals, mesh.morphs, weights, out, normals}).Run().ok());
  return out;
}

TEST(MorphConversion, TargetsAreInMetresAndZUpAndCurvesMoveThem) {
  const Converted made(morphing_leg().dump());
  ASSERT_EQ(made.asset.meshes.size(), 1u);
  const Mesh& mesh = made.asset.meshes[0];
  ASSERT_EQ(mesh.morphs.size(), 2u);
  EXPECT_EQ(made.curve(0, 0), "smile");
  EXPECT_EQ(made.curve(0, 1), "frown");
  // y goes up, z forward along x.
  const std::vector<float> smiling = morphed(mesh, {1, 0}), frowning = morphed(mesh, {0, 2});
  EXPECT_NEAR(smiling[3 + 2] - mesh.positions[3 + 2], 0.25f, 1e-5f);
  EXPECT_NEAR(smiling[3] - mesh.positions[3], 0, 1e-5f);
  EXPECT_NEAR(frowning[6] - mesh.positions[6], 1, 1e-4f);
  EXPECT_NEAR(made.rest("smile"), 0.25, 1e-6);
  EXPECT_NEAR(made.rest("frown"), 0, 1e-6);
  EXPECT_NEAR(made.value("smile", 0), 0, kRounded);
  EXPECT_NEAR(made.value("smile", 0.25), 0.5, kFit);
  EXPECT_NEAR(made.value("smile", 0.5), 1, kRounded);
  EXPECT_NEAR(made.value("smile", 1), 0.5, kRounded);
  EXPECT_NEAR(made.value("frown", 0.75), 0.125, kFit);
  EXPECT_EQ(made.report["morph_targets"], json({"frown", "smile"}));
  EXPECT_THAT(report_text(made.report, Detail::kWhole), HasSubstr("morph targets: frown smile"));
  EXPECT_THAT(report_text(made.report, Detail::kFolded), HasSubstr("2 morph targets"));
}

TEST(MorphConversion, UnitsHoldForTargetsToo) {
  const Scratch scratch;
  const std::string file = scratch.write("leg.gltf", morphing_leg().dump()).string();
  Asset asset;
  json report;
  ASSERT_EQ(convert_files({file}, {{"unit", 0.5}}, asset, report).message, "");
  const Mesh& mesh = asset.meshes.at(0);
  EXPECT_NEAR(morphed(mesh, {1, 0})[5] - mesh.positions[5], 0.125f, 1e-5f);
}

TEST(MorphConversion, WhatJsonSaysOfACurveOfThatNameCounts) {
  const std::string keys = R"({"kick": {"curves": {"smile": [[0, 0.75]]}}})";
  const Converted beside(morphing_leg().dump(), R"({"curves": {"smile": 0.5}, "clips": )" + keys + "}");
  EXPECT_NEAR(beside.rest("smile"), 0.5, 1e-6);
  EXPECT_NEAR(beside.value("smile", 0.5), 0.75, kFit);
  EXPECT_NEAR(beside.value("frown", 0.75), 0.125, kFit);  // as in the source
  json gltf = morphing_leg();
  gltf["extras"]["sinew"] = {{"clips", json::parse(keys)}};
  EXPECT_NEAR(Converted(gltf.dump()).value("smile", 0.5), 0.75, kFit);
  gltf = morphing_leg();
  gltf["animations"][0]["extras"]["sinew"]["curves"]["smile"] = json::parse("[[0, 0.75]]");
  EXPECT_NEAR(Converted(gltf.dump()).value("smile", 0.5), 0.75, kFit);
}

TEST(MorphConversion, TargetsOfOneNameFollowOneCurve) {
  Morphing with;
  with.meshes = 2;
  const Converted made(morphing_leg(with).dump());
  ASSERT_EQ(made.asset.meshes.size(), 2u);
  EXPECT_EQ(made.asset.curve_slots.size(), 2u);
  EXPECT_EQ(made.asset.meshes[0].morph_curves, made.asset.meshes[1].morph_curves);
  // Also where both are animated, each in its own way: the first counts, and that is said.
  json gltf = morphing_leg(with);
  json& animation = gltf["animations"][0];
  animation["channels"].push_back({{"sampler", 1}, {"target", {{"node", 3}, {"path", "weights"}}}});
  EXPECT_THAT(Converted(gltf.dump()).report["notes"], testing::Not(Contains(HasSubstr("move apart"))));
  const std::size_t output = animation["samplers"][1]["output"],
                    view = gltf["accessors"][output]["bufferView"];
  gltf["accessors"].push_back(gltf["accessors"][output]);
  gltf["bufferViews"].push_back(gltf["bufferViews"][view]);
  gltf["bufferViews"].back()["byteOffset"] = 0;  // other numbers
  gltf["accessors"].back()["bufferView"] = gltf["bufferViews"].size() - 1;
  animation["samplers"].push_back({{"input", 0}, {"output", gltf["accessors"].size() - 1}});
  animation["channels"].back()["sampler"] = 2;
  const Converted apart(gltf.dump());
  EXPECT_THAT(apart.report["notes"], Contains(HasSubstr("'smile' of several meshes move apart")));
}

TEST(MorphConversion, TargetsWithoutNamesAreCalledByMeshAndNumber) {
  json gltf = morphing_leg();
  gltf["meshes"][0].erase("extras");
  const Converted made(gltf.dump());
  EXPECT_EQ(made.curve(0, 0), "skin0 0");
  EXPECT_EQ(made.curve(0, 1), "skin0 1");
  EXPECT_NEAR(made.value("skin0 0", 0.25), 0.5, kFit);
}

TEST(MorphConversion, AMeshOfTwoNodesMovesOnBoth) {
  json gltf = morphing_leg();
  gltf["nodes"].push_back({{"name", "twin"}, {"mesh", 0}, {"skin", 0}});
  gltf["scenes"][0]["nodes"].push_back(3);
  const Converted made(gltf.dump());
  ASSERT_EQ(made.asset.meshes.size(), 2u);
  EXPECT_EQ(made.asset.meshes[0].morph_curves, made.asset.meshes[1].morph_curves);
  EXPECT_EQ(made.asset.meshes[1].morphs.size(), 2u);
}

TEST(MorphConversion, TargetsThatMoveNothingAreLeftOutWithTheirCurves) {
  Morphing with;
  with.smile.assign(9, 0);
  const Converted made(morphing_leg(with).dump());
  ASSERT_EQ(made.asset.meshes.at(0).morphs.size(), 1u);
  EXPECT_EQ(made.curve(0, 0), "frown");
  EXPECT_EQ(made.asset.find_curve("smile"), -1);
  EXPECT_NEAR(made.value("frown", 0.75), 0.125, kFit);
}

TEST(MorphConversion, AClipOfNothingButWeightsIsAClip) {
  json gltf = morphing_leg();
  gltf["animations"][0]["channels"].erase(0);
  const Converted made(gltf.dump());
  ASSERT_EQ(made.asset.clips.size(), 1u);
  EXPECT_NEAR(made.asset.clips[0].duration, 1, 1e-5f);
  EXPECT_NEAR(made.value("smile", 0.75), 0.75, kFit);
}

// Joints alone would say that it loops.
TEST(MorphConversion, AFaceThatDoesNotComeBackIsNoLoop) {
  Morphing with;
  with.keys = {0, 0, 0.5f, 0, 1, 0};
  json gltf = morphing_leg(with);
  gltf["animations"][0]["channels"].erase(0);
  const Converted made(gltf.dump());
  EXPECT_FALSE(made.asset.clips.at(0).loops);
  EXPECT_NEAR(made.value("smile", 1), 1, kRounded);
  with.keys[4] = 0;
  gltf = morphing_leg(with);
  gltf["animations"][0]["channels"].erase(0);
  EXPECT_TRUE(Converted(gltf.dump()).asset.clips.at(0).loops);
}

TEST(MorphConversion, AMeshThatOnlyMorphsNeedsNoJoints) {
  json gltf = morphing_leg();
  gltf["animations"][0]["channels"].erase(0);
  gltf["nodes"][2].erase("skin");
  gltf.erase("skins");
  for (const char* key : {"JOINTS_0", "WEIGHTS_0"})
    gltf["meshes"][0]["primitives"][0]["attributes"].erase(key);
  const Converted made(gltf.dump());
  ASSERT_EQ(made.asset.skeleton.joints.size(), 1u);
  EXPECT_NEAR(made.value("smile", 0.75), 0.75, kFit);
}

// Clips of another skeleton bring their curves before the character's own are there.
TEST(MorphConversion, ClipsOfAnotherSkeletonMoveTheTargetsOfTheirCurvesNames) {
  const Scratch scratch;
  std::string bvh = import::test::walking_bvh();
  for (const auto& [from, to] : {std::pair("hip", "base"), {"leg", "tail"}})
    bvh.replace(bvh.find(from), 3, to);
  const std::vector<std::string> files = {scratch.write("leg.gltf", morphing_leg().dump()).string(),
                                          scratch.write("other.bvh", bvh).string()};
  const AddForeignClips add = [](const std::string&, const Options&, Asset& character, json& report) {
    character.curve_slots = {{"wink", 0}, {"smile", 0.75f}};
    character.event_names = {"hit"};
    Clip clip = character.clips.at(0);
    clip.name = "foreign";
    clip.curves = {{1, clip.duration, std::vector<float>(4, 0.5f)}};
    clip.events = {{0.25f, 0.25f, event_name("hit")}};
    character.clips.push_back(clip);
    report["clips"].push_back({{"name", clip.name}});
    return Error{};
  };
  Asset asset, back;
  json report;
  ASSERT_EQ(convert_files(files, {{"retarget", true}}, asset, report, add).message, "");
  ASSERT_TRUE(read_asset(write_asset(asset), back).ok());
  const int smile = back.find_curve("smile");
  ASSERT_GE(smile, 0);
  EXPECT_EQ(back.curve_slots.size(), 3u);
  EXPECT_EQ(back.curve_slots[static_cast<std::size_t>(smile)].rest, 0.25f);  // the character's
  EXPECT_EQ(back.meshes.at(0).morph_curves.at(0), smile);
  ASSERT_EQ(back.clips.size(), 2u);
  EXPECT_EQ(back.clips[0].curves.size(), 2u);
  ASSERT_EQ(back.clips[1].curves.size(), 1u);
  EXPECT_EQ(back.clips[1].curves[0].slot, smile);
  EXPECT_EQ(back.clips[1].events.size(), 1u);
  EXPECT_THAT(back.event_names, ElementsAre("hit"));
}

TEST(MorphConversion, OfFbxFiles) {
  const Converted made(import::test::fbx_face(), "", "leg.fbx");
  EXPECT_NEAR(made.rest("smile"), 0, 1e-6);
  EXPECT_NEAR(made.value("smile", 0.5), 0.5, kFit);
  EXPECT_NEAR(made.value("frown", 0.25), 0.25, kFit);
}

}  // namespace
}  // namespace sinew::convert
