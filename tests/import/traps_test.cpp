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

TEST(Gltf, MissingTextureIsNoted) {
  Json gltf = with_triangle(kicking_leg(), 0);
  gltf["images"] = {{{"uri", "skin.png"}}};
  gltf["textures"] = {{{"source", 0}}};
  gltf["materials"] = Json::parse(
      R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 0.25, 1, 1]}}])");
  gltf["meshes"][0]["primitives"][0]["material"] = 0;
  const Scratch scratch;
  const auto file = scratch.write("a.gltf", gltf.dump());
  Outcome outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_THAT(outcome.scene.notes, testing::Contains("texture 'skin.png' not found; left out"));
  scratch.write("skin.png", "encoded");
  outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceMaterial& material = outcome.scene.materials[outcome.scene.meshes[0].material];
  EXPECT_EQ(std::string(material.texture.begin(), material.texture.end()), "encoded");
  EXPECT_EQ(material.base_color[1], 0.25f);
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

TEST(Bvh, FrameTimeGivesTheRate) {
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

TEST(Urdf, PrimitiveShapesAndMeshesAreTold) {
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
  EXPECT_EQ(link.mesh_count, 1);
}

TEST(Format, IsFoundByContentAndNotByExtension) {
  const Outcome outcome = read_content("a.fbx", walking_bvh());
  EXPECT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.format, "bvh");
}

}  // namespace
}  // namespace sinew::import::test
