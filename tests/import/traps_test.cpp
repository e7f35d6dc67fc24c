// Oddities of sound files (the traps of ../shared/research/real-data.md that belong to reading).
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "reading.h"

namespace sinew::import::test {
namespace {

using Json = nlohmann::json;

Outcome read_gltf(const Json& document) {
  return read_content("a.gltf", document.dump());
}

TEST(Gltf, ClipTurnsTheLeg) {
  const Outcome outcome = read_gltf(kicking_leg());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceScene& scene = outcome.scene;
  ASSERT_EQ(scene.clips.size(), 1u);
  EXPECT_EQ(scene.clips[0].name, "kick");
  EXPECT_DOUBLE_EQ(scene.clips[0].duration, 1);
  EXPECT_DOUBLE_EQ(scene.clips[0].key_rate, 2);
  ASSERT_EQ(scene.clips[0].channels.size(), 1u);
  const SourceChannel& channel = scene.clips[0].channels[0];
  EXPECT_EQ(channel.node, index_of(scene, "leg"));
  // 1e-6: the file's floats
  EXPECT_NEAR(channel.rotations[1].angularDistance(Eigen::Quaterniond::Identity()), std::numbers::pi / 4,
              1e-6);
  EXPECT_EQ(scene.nodes[channel.node].local(1, 3), -0.5);
  EXPECT_EQ(scene.meters_per_unit, 1);
  EXPECT_EQ(scene.up_axis, 1);
}

// Trap 10: a mesh node before the joint of the same name must not catch the joint's channel.
TEST(Gltf, ChannelGoesToItsNodeAndNotToAnotherOfTheSameName) {
  Json gltf = with_triangle(kicking_leg(), 0);
  gltf["nodes"].push_back({{"name", "leg"}});  // 2: a joint by the looks, not animated
  gltf["nodes"].push_back({{"name", "leg"}});  // 3: a mesh
  gltf["nodes"][3]["mesh"] = 0;
  gltf["nodes"][0]["children"] = {3, 2, 1};
  gltf["nodes"][2]["children"] = Json::array();
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceScene& scene = outcome.scene;
  const SourceNode& moved = scene.nodes[scene.clips[0].channels[0].node];
  EXPECT_EQ(moved.original_name, "leg");
  EXPECT_EQ(moved.local(1, 3), -0.5);  // only the true leg is half a metre down
  EXPECT_THAT(scene.notes, testing::Contains("2 nodes shared a name; renamed"));
}

TEST(Gltf, OfAJointAndAMeshWithOneNameTheJointKeepsIt) {
  Json gltf = with_triangle(kicking_leg(), 0);
  gltf["nodes"].push_back({{"name", "leg"}, {"mesh", 0}});
  gltf["nodes"][0].erase("mesh");
  gltf["nodes"][0]["children"] = {2, 1};
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.clips[0].channels[0].node, index_of(outcome.scene, "leg"));
  ASSERT_EQ(outcome.scene.meshes.size(), 1u);
  EXPECT_EQ(outcome.scene.meshes[0].node, index_of(outcome.scene, "leg_2"));
}

TEST(Gltf, NodesAndClipsWithoutNamesGetSome) {  // trap 11
  Json gltf = kicking_leg();
  gltf["nodes"][0].erase("name");
  gltf["nodes"][1].erase("name");
  gltf["animations"][0].erase("name");
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.clips[0].channels[0].node, index_of(outcome.scene, "node_1"));
  EXPECT_EQ(outcome.scene.nodes[1].original_name, "");
  EXPECT_FALSE(outcome.scene.clips[0].name.empty());
}

TEST(Gltf, NodesOfOtherScenesAreLeftOutAndNoted) {
  Json gltf = kicking_leg();
  EXPECT_TRUE(read_gltf(gltf).scene.notes.empty());
  gltf["nodes"].push_back({{"name", "stage"}, {"children", Json::array({3})}});
  gltf["nodes"].push_back({{"name", "lamp"}});
  gltf["scenes"].push_back({{"nodes", Json::array({2})}});
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(index_of(outcome.scene, "lamp"), -1);
  EXPECT_THAT(outcome.scene.notes,
              testing::Contains("2 nodes are not in the file's default scene; left out"));
}

TEST(Gltf, MeshesOfPointsOrLinesAreLeftOutAndNoted) {
  for (const int mode : {0, 1, 2, 3}) {
    Json gltf = with_triangle(kicking_leg(), 1);
    gltf["meshes"][0]["primitives"][0]["mode"] = mode;
    const Outcome outcome = read_gltf(gltf);
    ASSERT_TRUE(outcome.ok) << outcome.error;
    EXPECT_TRUE(outcome.scene.meshes.empty());
    EXPECT_THAT(outcome.scene.notes, testing::Contains("mesh 'skirt' is of points or lines; left out"))
        << mode;
  }
}

TEST(Gltf, MeshOnTwoNodesIsReadTwice) {
  Json gltf = with_triangle(kicking_leg(), 0);
  gltf["nodes"][1]["mesh"] = 0;
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.meshes.size(), 2u);
  EXPECT_NE(outcome.scene.meshes[0].node, outcome.scene.meshes[1].node);
}

TEST(Gltf, FirstKeyThatComesLateBeginsTheClip) {  // trap 18
  Json gltf = kicking_leg();
  set_buffer(gltf, {1, 1.5f, 2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_DOUBLE_EQ(outcome.scene.clips[0].duration, 1);
  EXPECT_THAT(outcome.scene.clips[0].channels[0].rotation_times, testing::ElementsAre(0, 0.5, 1));
  EXPECT_THAT(outcome.scene.notes, testing::Contains(testing::HasSubstr("moved to 0")));
}

TEST(Gltf, ClipOfOneKeyLastsNoTime) {  // trap 17
  Json gltf = kicking_leg();
  gltf["accessors"][0]["count"] = gltf["accessors"][1]["count"] = 1;
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.clips[0].duration, 0);
  EXPECT_EQ(outcome.scene.clips[0].key_rate, 0);
}

TEST(Gltf, KeysThatGoBackInTimeAreLeftOutAndNoted) {
  Json gltf = kicking_leg();
  set_buffer(gltf, {0.5f, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_THAT(outcome.scene.clips[0].channels[0].rotation_times, testing::ElementsAre(0, 0.5));
  EXPECT_THAT(outcome.scene.notes, testing::Contains(testing::HasSubstr("1 keys out of order")));
}

TEST(Gltf, FileWithoutMeshIsAccepted) {  // trap 16
  const Outcome outcome = read_gltf(kicking_leg());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_TRUE(outcome.scene.meshes.empty());
  EXPECT_TRUE(outcome.scene.nodes[index_of(outcome.scene, "leg")].is_bone);
}

TEST(Gltf, SayingTheSameInGlbGivesTheSame) {
  const Outcome text = read_gltf(with_triangle(kicking_leg(), 0));
  const Outcome binary =
      read_content("a.glb", as_glb(with_triangle(kicking_leg(), 0), kick_keys_and_corners()));
  ASSERT_TRUE(text.ok) << text.error;
  ASSERT_TRUE(binary.ok) << binary.error;
  EXPECT_EQ(binary.scene.nodes.size(), text.scene.nodes.size());
  EXPECT_EQ(binary.scene.meshes[0].positions, text.scene.meshes[0].positions);
  EXPECT_EQ(binary.scene.clips[0].channels[0].rotation_times, text.scene.clips[0].channels[0].rotation_times);
}

TEST(Gltf, CurvesThatAreReadAsLinesAreNoted) {
  Json gltf = kicking_leg();
  gltf["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_THAT(outcome.scene.notes, testing::Contains("animation 0: 1 stepped curves read as lines"));
}

TEST(Gltf, RateIsThatOfTheChannelWithTheClosestKeys) {  // trap 20
  Json gltf = kicking_leg();
  std::vector<float> values = kick_keys();
  const std::size_t times = append(gltf, values, {0, 1}, "SCALAR", 2);
  gltf["accessors"][times].update({{"min", {0}}, {"max", {1}}});
  const std::size_t places = append(gltf, values, {0, 0, 0, 0, 1, 0}, "VEC3", 2);
  gltf["animations"][0]["samplers"].push_back({{"input", times}, {"output", places}});
  gltf["animations"][0]["channels"].push_back(
      {{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}});
  set_buffer(gltf, values);
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_DOUBLE_EQ(outcome.scene.clips[0].key_rate, 2);
}

TEST(Gltf, RotationKeysAreBroughtToLengthOne) {  // trap 25
  Json gltf = kicking_leg();
  set_buffer(gltf, {0, 0.5f, 1, 0, 0, 0, 2, 0.5f, 0, 0, 0, 0, 0, 0, 1});
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  for (const Eigen::Quaterniond& q : outcome.scene.clips[0].channels[0].rotations)
    EXPECT_NEAR(q.norm(), 1, 1e-12);
}

TEST(Gltf, MirrorsAndUnevenScalesStayInTheNodes) {  // traps 30 and 31
  Json gltf = kicking_leg();
  gltf["nodes"][1]["scale"] = {-1, 2, 3};
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const Eigen::Matrix4d& local = outcome.scene.nodes[index_of(outcome.scene, "leg")].local;
  EXPECT_EQ(local.diagonal(), Eigen::Vector4d(-1, 2, 3, 1));
}

TEST(Gltf, PartsThatAMirrorsAnimationLeavesAloneStay) {  // trap 31
  Json gltf = kicking_leg();
  gltf["nodes"][1]["scale"] = {-1, 1, 1};
  gltf["animations"][0]["channels"][0]["target"] = {{"node", 0}, {"path", "rotation"}};
  gltf["nodes"][0]["scale"] = {-1, 1, 1};
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceChannel& channel = outcome.scene.clips.at(0).channels.at(0);
  ASSERT_FALSE(channel.scales.empty());
  EXPECT_EQ(channel.scales[0], Eigen::Vector3d(-1, 1, 1));
}

TEST(Gltf, ChannelsThatMoveNoNodeAreLeftOut) {  // trap 53
  Json gltf = kicking_leg();
  Json& channels = gltf["animations"][0]["channels"];
  const Json rotation = channels[0];
  const auto pointer = [](const char* to) {
    return Json{{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", to}}}}}};
  };
  channels.push_back({{"sampler", 0}, {"target", pointer("/materials/0/emissiveFactor")}});
  channels.push_back({{"sampler", 0}, {"target", {{"path", "translation"}}}});
  const Outcome outcome = read_gltf(gltf);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.clips.at(0).channels.size(), 1u);
  EXPECT_THAT(outcome.scene.notes, testing::Contains("animation 0: 2 channels move no node, not read"));
  // What points at a node's rotation is a channel as any.
  const std::size_t node = rotation["target"]["node"];
  channels = Json::array({rotation});
  channels[0]["target"] = pointer(("/nodes/" + std::to_string(node) + "/rotation").c_str());
  const Outcome pointed = read_gltf(gltf);
  ASSERT_TRUE(pointed.ok) << pointed.error;
  ASSERT_EQ(pointed.scene.clips.at(0).channels.size(), 1u);
  EXPECT_EQ(pointed.scene.clips[0].channels[0].node, outcome.scene.clips[0].channels[0].node);
  EXPECT_EQ(pointed.scene.clips[0].channels[0].rotations.size(),
            outcome.scene.clips[0].channels[0].rotations.size());
}

TEST(Gltf, ExtensionThatOnlyTouchesTheLooksIsNoObstacle) {
  Json gltf = kicking_leg();
  gltf["extensionsRequired"] = {"KHR_texture_transform"};
  const Outcome outcome = read_gltf(gltf);
  EXPECT_TRUE(outcome.ok) << outcome.error;
}

TEST(Bvh, JointsAreBonesAndEndSitesAreNot) {
  const Outcome outcome = read_content("a.bvh", walking_bvh());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceScene& scene = outcome.scene;
  ASSERT_EQ(scene.nodes.size(), 3u);
  EXPECT_TRUE(scene.nodes[index_of(scene, "hip")].is_bone);
  EXPECT_TRUE(scene.nodes[index_of(scene, "leg")].is_bone);
  EXPECT_FALSE(scene.nodes[2].is_bone);
  EXPECT_TRUE(scene.meshes.empty());  // assimp's stick figure is not the file's
  EXPECT_EQ(scene.meters_per_unit, 0);
  EXPECT_EQ(scene.up_axis, -1);
}

TEST(Bvh, FrameTimeGivesTheRate) {  // trap 19
  const Outcome outcome = read_content("a.bvh", walking_bvh());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_NEAR(outcome.scene.clips[0].key_rate, 50, 1e-4);  // the file's 0.02 s pass through a float
  EXPECT_NEAR(outcome.scene.clips[0].duration, 0.02, 1e-6);
}

TEST(Bvh, ChannelsTurnInTheOrderOfTheFile) {
  const Outcome outcome =
      read_content("a.bvh", short_bvh("Frames: 1\nFrame Time: 0.02\n0 0 0 0 0 0 90 90 0\n"));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const int leg = index_of(outcome.scene, "leg");
  for (const SourceChannel& channel : outcome.scene.clips[0].channels) {
    if (channel.node != leg) continue;
    const Eigen::Quaterniond expected = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());
    EXPECT_LT(channel.rotations[0].angularDistance(expected), 1e-6);  // assimp's floats
    return;
  }
  FAIL() << "the leg has no channel";
}

TEST(Bvh, RotationsMayComeBeforePositionsAndInAnyOrder) {  // trap 22
  const Outcome outcome = read_content(
      "a.bvh",
      "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 6 Yrotation Xrotation Zrotation Xposition Zposition "
      "Yposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n90 90 0 1 3 2\n");
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceChannel& hip = outcome.scene.clips[0].channels[0];
  EXPECT_EQ(hip.positions[0], Eigen::Vector3d(1, 2, 3));
  const Eigen::Quaterniond expected = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());
  EXPECT_LT(hip.rotations[0].angularDistance(expected), 1e-6);  // assimp's floats
}

TEST(Bvh, FramesBeyondTheirStatedNumberAreNotRead) {  // trap 21
  const Outcome outcome = read_content(
      "a.bvh",
      short_bvh("Frames: 2\nFrame Time: 0.5\n0 90 0 0 0 0 0 0 0\n1 90 0 0 0 0 0 0 0\n2 90 0 0 0 0 0 0 0\n"));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_DOUBLE_EQ(outcome.scene.clips[0].duration, 0.5);
}

TEST(Bvh, AnglesThatWrapAreTheSameRotation) {  // trap 23
  const Outcome outcome = read_content(
      "a.bvh", short_bvh("Frames: 2\nFrame Time: 0.02\n0 0 0 0 0 0 179 0 0\n0 0 0 0 0 0 -181 0 0\n"));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  for (const SourceChannel& c : outcome.scene.clips[0].channels)
    for (const Eigen::Quaterniond& q : c.rotations)
      EXPECT_LT(q.angularDistance(c.rotations[0]), 1e-6);  // assimp's floats
}

TEST(Bvh, JointsOfLengthZeroStay) {  // trap 9
  const Outcome outcome = read_content(
      "a.bvh",
      "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT "
      "LHipJoint\n{\nOFFSET 0 "
      "0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\n}\nMOTION\nFrames: "
      "1\nFrame Time: 0.1\n0 0 0 0 0 0\n");
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_TRUE(outcome.scene.nodes[index_of(outcome.scene, "LHipJoint")].is_bone);
}

TEST(Collada, UnitAndUpAxisAreInTheRoot) {  // trap 6
  const Outcome outcome = read_content(
      "a.dae",
      "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\">"
      "<asset><unit meter=\"0.5\"/><up_axis>Z_UP</up_axis></asset><library_visual_scenes><visual_scene "
      "id=\"s\">"
      "<node id=\"n\" name=\"n\"><translate>0 0 4</translate></node></visual_scene></library_visual_scenes>"
      "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>");
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceScene& scene = outcome.scene;
  EXPECT_EQ(scene.meters_per_unit, 1);
  EXPECT_EQ(scene.up_axis, 1);
  EXPECT_TRUE(scene.meshes.empty());
  Eigen::Vector4d place(0, 0, 0, 1);
  for (int n = index_of(scene, "n"); n >= 0; n = scene.nodes[n].parent) place = scene.nodes[n].local * place;
  EXPECT_TRUE(place.isApprox(Eigen::Vector4d(0, 2, 0, 1), 1e-6)) << place.transpose();  // floats
}

TEST(Urdf, JointIsReadWithAllThatItSays) {
  const Outcome outcome = read_content(
      "a.urdf",
      short_urdf(knee("<origin xyz=\"0 0 -0.5\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 2 0\"/>"
                      "<limit lower=\"-1\" upper=\"2\" effort=\"10\" velocity=\"5\"/>"
                      "<dynamics damping=\"0.1\" friction=\"0.2\"/>")));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.links.size(), 2u);
  const SourceUrdfLink& link = outcome.scene.links[1];
  EXPECT_EQ(link.joint_name, "knee");
  EXPECT_EQ(link.parent, 0);
  EXPECT_EQ(link.type, JointType::kRevolute);
  EXPECT_EQ(link.axis, Vec3<double>(0, 2, 0));
  EXPECT_EQ(link.origin.translation.z(), -0.5);
  EXPECT_NEAR(2 * std::acos(link.origin.rotation.w()), std::numbers::pi / 2, 1e-12);
  EXPECT_TRUE(link.has_limits);
  EXPECT_EQ(link.lower, -1);
  EXPECT_EQ(link.upper, 2);
  EXPECT_EQ(link.effort, 10);
  EXPECT_EQ(link.damping, 0.1);
  EXPECT_EQ(link.friction, 0.2);
}

TEST(Urdf, ContinuousJointHasNoLimitsAndNoneAreMadeUp) {  // trap 41
  const Outcome outcome = read_content("a.urdf", short_urdf(knee("", "continuous")));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.links[1].type, JointType::kRevolute);
  EXPECT_FALSE(outcome.scene.links[1].has_limits);
}

TEST(Urdf, LockedJointAndEffortOfZeroAreRead) {  // traps 40 and 43
  const Outcome outcome = read_content(
      "a.urdf", short_urdf(knee("<limit lower=\"0.5\" upper=\"0.5\" effort=\"0\" velocity=\"0\"/>")));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_TRUE(outcome.scene.links[1].has_limits);
  EXPECT_EQ(outcome.scene.links[1].lower, outcome.scene.links[1].upper);
  EXPECT_EQ(outcome.scene.links[1].effort, 0);
}

TEST(Urdf, LockedJointStandsWhereItIsLocked) {  // trap 43
  const auto origin = [](const char* type, const char* limit) {
    const Outcome outcome = read_content(
        "a.urdf",
        short_urdf(knee("<origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"2 0 0\"/>"
                        "<limit " +
                            std::string(limit) + " effort=\"10\" velocity=\"5\"/>",
                        type)));
    EXPECT_TRUE(outcome.ok) << outcome.error;
    return outcome.scene.links[1].origin;
  };
  const Transform<double> free = origin("revolute", "lower=\"-1\" upper=\"0.5\"");
  const Transform<double> turned = origin("revolute", "lower=\"0.5\" upper=\"0.5\"");
  EXPECT_LT(turned.rotation.angularDistance(free.rotation *
                                            Quat<double>(Eigen::AngleAxisd(0.5, Vec3<double>::UnitX()))),
            1e-12);
  EXPECT_EQ(turned.translation, free.translation);
  const Transform<double> moved = origin("prismatic", "lower=\"0.5\" upper=\"0.5\"");
  EXPECT_LT((moved.translation - Vec3<double>(0, 0.5, 1)).norm(), 1e-12);  // its x axis is the parent's y
  EXPECT_EQ(moved.rotation.coeffs(), free.rotation.coeffs());
}

TEST(Urdf, FloatingJointIsFree) {  // trap 46
  const Outcome outcome = read_content("a.urdf", short_urdf(knee("", "floating")));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.links[1].type, JointType::kFree);
}

TEST(Urdf, MimicNamesItsJoint) {  // trap 44
  const std::string other =
      std::string(
          "<link name=\"c\"/><joint name=\"toe\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/>") +
      kGoodLimit + "<mimic joint=\"knee\" multiplier=\"0.5\" offset=\"0.1\"/></joint>";
  const Outcome outcome = read_content("a.urdf", short_urdf(knee(kGoodLimit) + other));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.links[2].mimic_joint, "knee");
  EXPECT_EQ(outcome.scene.links[2].mimic_multiplier, 0.5);
  EXPECT_EQ(outcome.scene.links[2].mimic_offset, 0.1);
}

TEST(Urdf, ShapeThatUrdfdomDropsIsNoted) {  // trap 47
  const Outcome outcome = read_content(
      "a.urdf",
      short_urdf(knee(kGoodLimit),
                 "<collision><geometry><capsule radius=\"1\" length=\"2\"/></geometry></collision>"));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_THAT(outcome.scene.notes, testing::Contains(testing::StartsWith("urdfdom: ")));
}

TEST(Urdf, NamespaceThatXacroLeavesBehindIsNoMacro) {
  const std::string expanded =
      "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><!-- made by xacro: do not edit -->"
      "<link name=\"a\"/></robot>";
  const Outcome outcome = read_content("a.urdf", expanded);
  EXPECT_TRUE(outcome.ok) << outcome.error;
}

TEST(Urdf, PrimitiveShapesAndMeshesAreTold) {  // trap 49
  const Outcome outcome = read_content(
      "a.urdf", short_urdf(knee(kGoodLimit),
                           "<visual><geometry><box size=\"1 2 4\"/></geometry></visual>"
                           "<collision><geometry><sphere radius=\"3\"/></geometry></collision>"
                           "<visual><geometry><mesh filename=\"package://x/y.stl\"/></geometry></visual>"));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceUrdfLink& link = outcome.scene.links[0];
  ASSERT_EQ(link.shapes.size(), 2u);
  EXPECT_EQ(link.shapes[0].shape, Shape::kSphere);
  EXPECT_TRUE(link.shapes[0].collision);
  EXPECT_EQ(link.shapes[1].size, Vec3<double>(0.5, 1, 2));
  EXPECT_FALSE(link.shapes[1].collision);
  ASSERT_EQ(link.meshes.size(), 1u);
  EXPECT_EQ(link.meshes[0].file, "package://x/y.stl");
  EXPECT_FALSE(link.meshes[0].collision);
}

TEST(Format, IsFoundByContentAndNotByExtension) {
  const Outcome outcome = read_content("a.fbx", walking_bvh());
  EXPECT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.format, "bvh");
}

TEST(Format, FileNamesOfAnyBytesAreOpened) {
  for (const char* name :
       {"a b.bvh", "Läufer 走.bvh", "L\xe4ufer.bvh", "-o.bvh", "a\nb.bvh"}) {  // the third: Latin-1
    const Outcome outcome = read_content(name, walking_bvh());
    EXPECT_TRUE(outcome.ok) << name << ": " << outcome.error;
  }
}

TEST(Format, ByteOrderMarkOfUtf8IsSkipped) {
  const Outcome outcome = read_content("a.urdf", "\xEF\xBB\xBF" + short_urdf(knee(kGoodLimit)));
  EXPECT_TRUE(outcome.ok) << outcome.error;
}

}  // namespace
}  // namespace sinew::import::test
