// Skins, weights and textures come out as they stand in the file.
#include <gmock/gmock.h>

#include <bit>

#include "reading.h"

namespace sinew::import::test {
namespace {

using Json = nlohmann::json;

/// Three vertices' joint indices, four each, in the bits of floats.
std::vector<float> indices(std::uint32_t of_each_vertex) {
  return std::vector<float>(3, std::bit_cast<float>(of_each_vertex));
}

std::vector<float> three_times(std::vector<float> once) {
  std::vector<float> all;
  for (int i = 0; i < 3; ++i) all.insert(all.end(), once.begin(), once.end());
  return all;
}

/// Inverse bind matrices of two joints: moved by −x along X.
std::vector<float> binds(float x) {
  std::vector<float> all;
  for (int joint = 0; joint < 2; ++joint)
    for (const float v : {1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, -x, 0.f, 0.f, 1.f})
      all.push_back(v);
  return all;
}

/// kicking_leg() with a triangle that hangs on hip and leg by `weights` of each vertex; one skin and mesh for
/// each of `places`, the bind place along X.
Json skinned(const std::vector<float>& weights, const std::vector<float>& places) {
  Json gltf = kicking_leg();
  std::vector<float> values = kick_keys();
  const std::size_t position = append(gltf, values, corners(), "VEC3", 3);
  gltf["accessors"][position].update({{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
  Json attributes{{"POSITION", position},
                  {"JOINTS_0", append(gltf, values, indices(0x00000100), "VEC4", 3, 5121)},
                  {"WEIGHTS_0", append(gltf, values, three_times(weights), "VEC4", 3)}};
  for (std::size_t k = 0; k < places.size(); ++k) {
    gltf["skins"].push_back(
        {{"joints", {0, 1}}, {"inverseBindMatrices", append(gltf, values, binds(places[k]), "MAT4", 2)}});
    gltf["meshes"].push_back(
        {{"name", "skin" + std::to_string(k)}, {"primitives", {{{"attributes", attributes}}}}});
    gltf["nodes"].push_back({{"name", "body" + std::to_string(k)}, {"mesh", k}, {"skin", k}});
    gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size() - 1);
  }
  set_buffer(gltf, values);
  return gltf;
}

TEST(Skin, WeightsComeAsInTheFileWhateverTheirSum) {  // trap 27
  const Outcome outcome = read_content("a.gltf", skinned({0.25f, 0.25f, 0, 0}, {0}).dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  const SourceScene& scene = outcome.scene;
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].bones.size(), 2u);
  for (const SourceMesh::Bone& bone : scene.meshes[0].bones) {
    EXPECT_TRUE(scene.nodes[bone.node].is_bone);
    ASSERT_EQ(bone.weights.size(), 3u);
    EXPECT_EQ(bone.weights[0].second, 0.25f);
  }
}

TEST(Skin, BoneWithoutWeightsStays) {  // trap 12: control bones
  const Outcome outcome = read_content("a.gltf", skinned({1, 0, 0, 0}, {0}).dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_TRUE(outcome.scene.nodes[index_of(outcome.scene, "leg")].is_bone);
}

TEST(Skin, OneBoneMayHaveABindMatrixPerMesh) {  // traps 32 and 33
  const Outcome outcome = read_content("a.gltf", skinned({0.5f, 0.5f, 0, 0}, {1, 2}).dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.meshes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const SourceMesh& mesh = outcome.scene.meshes[k];
    EXPECT_EQ(mesh.bones[0].inverse_bind(0, 3), mesh.name == "skin0" ? -1 : -2) << mesh.name;
    EXPECT_EQ(mesh.node, index_of(outcome.scene, mesh.name == "skin0" ? "body0" : "body1"));
  }
}

const std::string kPng("\x89PNG\r\n\x1a\n", 8);

/// with_triangle() painted with an image.
Json painted(const Json& image) {
  Json gltf = with_triangle(kicking_leg(), 0);
  gltf["images"] = Json::array({image});
  gltf["textures"] = {{{"source", 0}}};
  gltf["materials"] = Json::parse(
      R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 0.25, 1, 1]}}])");
  gltf["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

std::string texture_of(const SourceScene& scene) {
  const SourceMaterial& material = scene.materials.at(static_cast<std::size_t>(scene.meshes.at(0).material));
  EXPECT_EQ(material.base_color[1], 0.25f);
  return {material.texture.begin(), material.texture.end()};
}

TEST(Texture, BesideTheFileIsReadAndOneThatIsMissingIsNoted) {
  const Scratch scratch;
  const auto file = scratch.write("a.gltf", painted({{"uri", "skin.png"}}).dump());
  Outcome outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(texture_of(outcome.scene), "");
  EXPECT_THAT(outcome.scene.notes, testing::Contains("texture 'skin.png' not found; left out"));
  scratch.write("skin.png", kPng);
  outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(texture_of(outcome.scene), kPng);
}

TEST(Texture, OfAnotherFormatIsNoted) {
  const Scratch scratch;
  scratch.write("skin.tga", std::string(64, '\0'));
  const Outcome outcome = read(scratch.write("a.gltf", painted({{"uri", "skin.tga"}}).dump()));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(texture_of(outcome.scene), "");
  EXPECT_THAT(outcome.scene.notes, testing::Contains("texture 'skin.tga' is neither PNG nor JPEG; left out"));
}

TEST(Texture, EmbeddedAsDataIsRead) {
  const Outcome outcome =
      read_content("a.gltf", painted({{"uri", "data:image/png;base64,iVBORw0KGgo="}}).dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(texture_of(outcome.scene), kPng);
}

TEST(Texture, EmbeddedInTheGlbIsRead) {
  Json gltf = painted({{"mimeType", "image/png"}});
  std::vector<float> values = kick_keys_and_corners();
  float words[2];
  std::memcpy(words, kPng.data(), sizeof words);
  append(gltf, values, {words[0], words[1]}, "SCALAR", 2);
  gltf["images"][0]["bufferView"] = gltf["bufferViews"].size() - 1;
  const Outcome outcome = read_content("a.glb", as_glb(gltf, values));
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(texture_of(outcome.scene), kPng);
}

}  // namespace
}  // namespace sinew::import::test
