// kicking_leg() with skins.
#pragma once

#include <bit>
#include <cstring>

#include "reading.h"

namespace sinew::import::test {

/// Three vertices' joint indices, four each, in the bits of floats.
inline std::vector<float> indices(std::uint32_t of_each_vertex) {
  return std::vector<float>(3, std::bit_cast<float>(of_each_vertex));
}

inline std::vector<float> three_times(std::vector<float> once) {
  std::vector<float> all;
  for (int i = 0; i < 3; ++i) all.insert(all.end(), once.begin(), once.end());
  return all;
}

/// Inverse bind matrices of two joints: moved by −x along X.
inline std::vector<float> binds(float x) {
  std::vector<float> all;
  for (int joint = 0; joint < 2; ++joint)
    for (const float v : {1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, -x, 0.f, 0.f, 1.f})
      all.push_back(v);
  return all;
}

/// Numbers of any type in the bits of floats.
template <class Number>
std::vector<float> packed(const std::vector<Number>& numbers) {
  std::vector<float> bits((numbers.size() * sizeof(Number) + sizeof(float) - 1) / sizeof(float));
  std::memcpy(bits.data(), numbers.data(), numbers.size() * sizeof(Number));
  return bits;
}

/// kicking_leg() with a triangle that hangs on hip and leg by `weights` of its three vertices, which are of
/// `component` type; one skin and mesh for each of `places`, the bind place along X. `values`: of its buffer.
inline nlohmann::json skinned_by(const std::vector<float>& weights, int component,
                                 const std::vector<float>& places, std::vector<float>& values) {
  nlohmann::json gltf = kicking_leg();
  values = kick_keys();
  const std::size_t position = append(gltf, values, corners(), "VEC3", 3);
  gltf["accessors"][position].update({{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
  nlohmann::json attributes{{"POSITION", position},
                            {"JOINTS_0", append(gltf, values, indices(0x00000100), "VEC4", 3, 5121)},
                            {"WEIGHTS_0", append(gltf, values, weights, "VEC4", 3, component)}};
  if (component != 5126) gltf["accessors"].back()["normalized"] = true;
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

/// The same by float weights, the same for each vertex.
inline nlohmann::json skinned(const std::vector<float>& weights, const std::vector<float>& places) {
  std::vector<float> values;
  return skinned_by(three_times(weights), 5126, places, values);
}

}  // namespace sinew::import::test
