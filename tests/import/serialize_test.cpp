// The answer of the sandboxed reader is not trusted: damaged bytes must neither crash nor pass as a scene.
#include "import/serialize.h"

#include <cstring>
#include <random>

#include "import/scene_check.h"
#include "reading.h"

namespace sinew::import::test {
namespace {

/// Something of everything, so that every field is crossed.
SourceScene full_scene() {
  SourceScene s;
  s.format = "gltf";
  s.name = "full";
  s.meters_per_unit = 0.01;
  s.up_axis = 2;
  s.nodes.resize(2);
  s.nodes[0].name = "hip";
  s.nodes[1] = {.name = "leg", .original_name = "Leg", .parent = 0, .is_bone = true};
  s.nodes[1].local(0, 3) = 0.25;
  SourceMesh mesh;
  mesh.name = "skin";
  mesh.node = 0;
  mesh.positions = mesh.normals = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.indices = {0, 1, 2};
  mesh.bones.push_back({1, Eigen::Matrix4d::Identity(), {{0, 0.5f}, {2, 1.f}}});
  mesh.material = 0;
  mesh.morphs.push_back({"smile", 0.5f, {{0, 0, 0}, {0, 0.25f, 0}, {0, 0, 0}}});
  mesh.morphs.push_back({"frown", 0, mesh.morphs[0].moves, mesh.morphs[0].moves});
  s.meshes.push_back(mesh);
  s.materials.push_back({"cloth", {1, 0.5f, 0.25f, 1}, {1, 2, 3}});
  SourceClip clip{.name = "walk",
                  .duration = 1,
                  .begin = 0.5,
                  .key_rate = 2,
                  .extras = "{}",
                  .channels = {},
                  .morphs = {}};
  SourceChannel channel;
  channel.node = 1;
  channel.position_times = channel.rotation_times = channel.scale_times = {0, 0.5};
  channel.positions = channel.scales = {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)};
  channel.rotations = {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(0, 1, 0, 0)};
  clip.channels.push_back(channel);
  clip.morphs.push_back({.mesh = 0, .times = {0, 0.5}, .weights = {0, 0.25f, 0.5f, 1}});
  s.clips.push_back(clip);
  SourceUrdfLink link;
  link.name = "base";
  link.has_inertial = true;
  link.mass = 3;
  link.shapes.push_back({});
  s.links.push_back(link);
  s.extras = R"({"author": 7})";
  s.notes = {"one", "two"};
  return s;
}

TEST(Serialize, BringsEverythingBack) {
  const std::string bytes = to_bytes(full_scene());
  SourceScene back;
  std::string error;
  ASSERT_TRUE(from_bytes(bytes, back, error)) << error;
  EXPECT_EQ(to_bytes(back), bytes);
  EXPECT_EQ(back.nodes[1].original_name, "Leg");
  EXPECT_EQ(back.nodes[1].local(0, 3), 0.25);
  EXPECT_EQ(back.meshes[0].bones[0].weights[1].first, 2u);
  EXPECT_EQ(back.clips[0].channels[0].positions[1].z(), 6);
  EXPECT_EQ(back.links[0].mass, 3);
  EXPECT_EQ(back.meshes[0].morphs[0].name, "smile");
  EXPECT_EQ(back.meshes[0].morphs[0].weight, 0.5f);
  EXPECT_EQ(back.meshes[0].morphs[1].tilts[1][1], 0.25f);
  EXPECT_EQ(back.clips[0].morphs[0].times[1], 0.5);
  EXPECT_EQ(back.clips[0].morphs[0].weights[3], 1);
}

TEST(Serialize, RefusesEveryTruncation) {
  const std::string bytes = to_bytes(full_scene());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SourceScene scene;
    std::string error;
    ASSERT_FALSE(from_bytes(bytes.substr(0, size), scene, error)) << size << " bytes";
    ASSERT_EQ(error, "the reader's answer is damaged");
  }
}

TEST(Serialize, RefusesBytesAfterTheEnd) {
  SourceScene scene;
  std::string error;
  EXPECT_FALSE(from_bytes(to_bytes(full_scene()) + "x", scene, error));
}

TEST(Serialize, WhatPassesAfterDamageIsSound) {
  constexpr unsigned kSeed = 20240607;
  std::mt19937 random(kSeed);
  const std::string bytes = to_bytes(full_scene());
  int refused = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string damaged = bytes;
    for (unsigned n = 1 + random() % 4; n-- > 0;)
      damaged[random() % damaged.size()] = static_cast<char>(random() % 3 == 0 ? 0xff : random());
    SourceScene scene;
    std::string error;
    if (from_bytes(damaged, scene, error)) {
      ASSERT_EQ(fault_in(scene), "") << "seed " << kSeed << ", case " << k;
    } else {
      ASSERT_FALSE(error.empty());
      ASSERT_TRUE(scene.nodes.empty());
      ++refused;
    }
  }
  EXPECT_GT(refused, 5000);  // else the damage did not reach anything
}

struct Fault {
  const char* name;
  void (*apply)(SourceScene&);
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

class SceneFault : public testing::TestWithParam<Fault> {};

TEST_P(SceneFault, IsFound) {
  SourceScene scene = full_scene();
  ASSERT_EQ(fault_in(scene), "");
  GetParam().apply(scene);
  EXPECT_NE(fault_in(scene), "");
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, SceneFault,
    testing::Values(
        Fault{"NegativeUnit", [](SourceScene& s) { s.meters_per_unit = -1; }},
        Fault{"UpAxisNowhere", [](SourceScene& s) { s.up_axis = 3; }},
        Fault{"ParentAfterChild", [](SourceScene& s) { s.nodes[0].parent = 1; }},
        Fault{"NodeNamedTwice", [](SourceScene& s) { s.nodes[1].name = "hip"; }},
        Fault{"NodeNan", [](SourceScene& s) { s.nodes[1].local(1, 1) = kNan; }},
        Fault{"MeshOnNoNode", [](SourceScene& s) { s.meshes[0].node = -1; }},
        Fault{"NoSuchMaterial", [](SourceScene& s) { s.meshes[0].material = 1; }},
        Fault{"NormalsMissing", [](SourceScene& s) { s.meshes[0].normals.pop_back(); }},
        Fault{"NormalNan", [](SourceScene& s) { s.meshes[0].normals[1][0] = kNanFloat; }},
        Fault{"VertexNan", [](SourceScene& s) { s.meshes[0].positions[1][0] = kNanFloat; }},
        Fault{"TextureCoordinateNan", [](SourceScene& s) { s.meshes[0].uvs[1][0] = kNanFloat; }},
        Fault{"IndexOutOfRange", [](SourceScene& s) { s.meshes[0].indices[2] = 3; }},
        Fault{"HalfATriangle", [](SourceScene& s) { s.meshes[0].indices.pop_back(); }},
        Fault{"BoneNowhere", [](SourceScene& s) { s.meshes[0].bones[0].node = 2; }},
        Fault{"WeightNan", [](SourceScene& s) { s.meshes[0].bones[0].weights[0].second = kNanFloat; }},
        Fault{"WeightOfNoVertex", [](SourceScene& s) { s.meshes[0].bones[0].weights[0].first = 3; }},
        Fault{"MorphTargetTooShort", [](SourceScene& s) { s.meshes[0].morphs[0].moves.pop_back(); }},
        Fault{"MorphTargetTiltsTooFew", [](SourceScene& s) { s.meshes[0].morphs[1].tilts.pop_back(); }},
        Fault{"MorphTargetNan", [](SourceScene& s) { s.meshes[0].morphs[0].moves[1][2] = kNanFloat; }},
        Fault{"MorphTargetTiltNan", [](SourceScene& s) { s.meshes[0].morphs[1].tilts[1][2] = kNanFloat; }},
        Fault{"MorphWeightNan", [](SourceScene& s) { s.meshes[0].morphs[0].weight = kNanFloat; }},
        Fault{"MorphsOfNoMesh", [](SourceScene& s) { s.clips[0].morphs[0].mesh = 1; }},
        Fault{"MorphKeyMissing", [](SourceScene& s) { s.clips[0].morphs[0].weights.pop_back(); }},
        Fault{"MorphKeyNan", [](SourceScene& s) { s.clips[0].morphs[0].weights[2] = kNanFloat; }},
        Fault{"MorphTimesFall", [](SourceScene& s) { s.clips[0].morphs[0].times[1] = -1; }},
        Fault{"ColourNan", [](SourceScene& s) { s.materials[0].base_color[3] = kNanFloat; }},
        Fault{"ChannelNowhere", [](SourceScene& s) { s.clips[0].channels[0].node = 2; }},
        Fault{"TimesFall", [](SourceScene& s) { s.clips[0].channels[0].scale_times[1] = -1; }},
        Fault{"TimeMissing", [](SourceScene& s) { s.clips[0].channels[0].position_times.pop_back(); }},
        Fault{"RotationZero", [](SourceScene& s) { s.clips[0].channels[0].rotations[0].coeffs().setZero(); }},
        Fault{"DurationNan", [](SourceScene& s) { s.clips[0].duration = kNan; }},
        Fault{"LinkIsItsParent", [](SourceScene& s) { s.links[0].parent = 0; }},
        Fault{"MassNegative", [](SourceScene& s) { s.links[0].mass = -1; }},
        Fault{"InertiaNan", [](SourceScene& s) { s.links[0].inertia(0, 1) = kNan; }},
        Fault{"VelocityNan", [](SourceScene& s) { s.links[0].velocity = kNan; }},
        Fault{"ShapeNan", [](SourceScene& s) { s.links[0].shapes[0].size[0] = kNan; }}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace sinew::import::test
