// Skins, weights and textures come out as they stand in the file.
#include <gmock/gmock.h>

#include "reading.h"
#include "skinned_leg.h"

namespace sinew::import::test {
namespace {

using Json = nlohmann::json;

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

// Unreal's exporter writes bytes, which assimp 5.2.5 copies into floats as they stand.
TEST(Skin, WeightsMayBeWholeNumbers) {  // trap 50
  const std::vector<std::uint8_t> bytes = {255, 0, 0, 0, 51, 204, 0, 0, 0, 255, 0, 0};
  const std::vector<std::uint16_t> words = {65535, 0, 0, 0, 13107, 52428, 0, 0, 0, 65535, 0, 0};
  for (const bool wide : {false, true}) {
    std::vector<float> values;
    const Json gltf = skinned_by(wide ? packed(words) : packed(bytes), wide ? 5123 : 5121, {0}, values);
    for (const std::string& file : {std::string("a.gltf"), std::string("a.glb")}) {
      const Outcome outcome = read_content(file, file == "a.glb" ? as_glb(gltf, values) : gltf.dump());
      ASSERT_TRUE(outcome.ok) << outcome.error;
      double weights[2][3] = {};
      for (const SourceMesh::Bone& bone : outcome.scene.meshes.at(0).bones)
        for (const auto& [vertex, weight] : bone.weights)
          weights[bone.node == index_of(outcome.scene, "leg")][vertex] = double(weight);
      const double wanted[2][3] = {{1, 0.2, 0}, {0, 0.8, 1}};
      for (const int bone : {0, 1})
        for (const int vertex : {0, 1, 2})
          EXPECT_NEAR(weights[bone][vertex], wanted[bone][vertex], 1e-6) << file << wide << bone << vertex;
    }
  }
}

TEST(Skin, WholeNumbersBeyondTheirBufferAreRefused) {
  std::vector<float> values;
  const std::vector<std::uint8_t> bytes(12, 255);
  const Json whole = skinned_by(packed(bytes), 5121, {0}, values);
  const std::size_t weights = whole["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"];
  const auto error = [&](const char* key, const Json& value, bool of_view = false) {
    Json gltf = whole;
    (of_view ? gltf["bufferViews"][gltf["accessors"][weights]["bufferView"].get<std::size_t>()]
             : gltf["accessors"][weights])[key] = value;
    return read_content("a.gltf", gltf.dump()).error;
  };
  const std::string what = "accessor " + std::to_string(weights);
  EXPECT_EQ(error("count", 4000000000u), what + " reaches beyond its view");
  EXPECT_EQ(error("byteOffset", 4), what + " reaches beyond its view");
  EXPECT_EQ(error("byteLength", 100000, true), what + " has a view that reaches beyond its buffer");
  EXPECT_EQ(error("byteStride", 1, true), what + " reaches beyond its view");
  EXPECT_EQ(error("sparse", {{"count", 1}}), what + " is sparse and normalised, which cannot be read");
  EXPECT_NE(error("bufferView", 99), "");
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

// assimp 5.2.5 crashes without them, and reads beyond the end of those that are too few.
TEST(Skin, WithoutBindMatricesIsModelledInItsJointsFrames) {  // trap 52
  std::vector<float> values;
  Json gltf = skinned_by(three_times({0.5f, 0.5f, 0, 0}), 5126, {3}, values);
  gltf["skins"][0].erase("inverseBindMatrices");
  for (const std::string& file : {std::string("a.gltf"), std::string("a.glb")}) {
    const Outcome outcome = read_content(file, file == "a.glb" ? as_glb(gltf, values) : gltf.dump());
    ASSERT_TRUE(outcome.ok) << outcome.error;
    ASSERT_EQ(outcome.scene.meshes.at(0).bones.size(), 2u);
    for (const SourceMesh::Bone& bone : outcome.scene.meshes[0].bones) {
      EXPECT_TRUE(bone.inverse_bind.isIdentity(0)) << bone.inverse_bind;
      ASSERT_EQ(bone.weights.size(), 3u);
      EXPECT_EQ(bone.weights[2].second, 0.5f);
    }
  }
}

// assimp 5.2.5 gives a mesh one skin, whichever of its nodes has which.
TEST(Skin, NodesThatShareAMeshHaveSkinsOfTheirOwn) {  // trap 54
  Json gltf = skinned({0.5f, 0.5f, 0, 0}, {1, 2});
  for (Json& node : gltf["nodes"])
    if (node.contains("mesh")) node["mesh"] = 0;
  gltf["nodes"].push_back({{"name", "stone"}, {"mesh", 0}});
  gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size() - 1);
  const Outcome outcome = read_content("a.gltf", gltf.dump());
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.meshes.size(), 3u);
  for (const SourceMesh& mesh : outcome.scene.meshes) {
    if (mesh.node == index_of(outcome.scene, "stone")) {
      EXPECT_TRUE(mesh.bones.empty());
    } else {
      ASSERT_EQ(mesh.bones.size(), 2u);
      EXPECT_EQ(mesh.bones[0].inverse_bind(0, 3), mesh.node == index_of(outcome.scene, "body0") ? -1 : -2);
    }
  }
}

TEST(Skin, BindMatricesAndJointsThatAreNotThereAreRefused) {
  const Json whole = skinned({0.5f, 0.5f, 0, 0}, {0});
  const auto error = [&](const char* key, const Json& value) {
    Json gltf = whole;
    gltf["skins"][0][key] = value;
    return read_content("a.gltf", gltf.dump()).error;
  };
  EXPECT_EQ(error("joints", {0, 1, 2}), "skin 0: not a bind matrix for each of its joints");
  EXPECT_EQ(error("joints", {0, 99}), "skin 0: a joint points nowhere");
  EXPECT_EQ(error("inverseBindMatrices", 0), "skin 0: not a bind matrix for each of its joints");
  EXPECT_EQ(error("inverseBindMatrices", 99), "skin 0: 'inverseBindMatrices' points nowhere");
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
