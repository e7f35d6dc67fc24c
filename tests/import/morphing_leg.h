// skinned() with morph targets.
#pragma once

#include "skinned_leg.h"

namespace sinew::import::test {

inline const std::vector<float> kSmile = {0, 0, 0, 0, 0.25f, 0, 0, 0, 0};  ///< lifts the second vertex
inline const std::vector<float> kFrown = {0, 0, 0, 0, 0, 0, 0, 0, 0.5f};   ///< pulls the third one forward

/// What a morphing leg is made with.
struct Morphing {
  std::vector<float> smile = kSmile, frown = kFrown;
  std::vector<float> keys = {0, 0.5f, 1, 0.25f, 0.5f, 0};  ///< [0, 0.5, 1 s][smile, frown]
  std::string interpolation = "LINEAR";
  int meshes = 1;  ///< skins with the same targets; all but the first are not animated
};

/// A skinned leg whose triangle has targets "smile" (0.25 at rest) and "frown", moved in its clip "kick".
inline nlohmann::json morphing_leg(const Morphing& with, std::vector<float>& values) {
  using nlohmann::json;
  const std::vector<float> places(static_cast<std::size_t>(with.meshes), 0);
  json gltf = skinned_by(three_times({1, 0, 0, 0}), 5126, places, values);
  json targets;
  for (const std::vector<float>* moves : {&with.smile, &with.frown})
    targets.push_back({{"POSITION", append(gltf, values, *moves, "VEC3", 3)}});
  for (json& mesh : gltf["meshes"]) {
    mesh["primitives"][0]["targets"] = targets;
    mesh["weights"] = {0.25, 0};
    mesh["extras"]["targetNames"] = {"smile", "frown"};
  }
  const std::size_t output = append(gltf, values, with.keys, "SCALAR", static_cast<int>(with.keys.size()));
  json& animation = gltf["animations"][0];
  animation["samplers"].push_back({{"input", 0}, {"output", output}, {"interpolation", with.interpolation}});
  animation["channels"].push_back({{"sampler", 1}, {"target", {{"node", 2}, {"path", "weights"}}}});
  set_buffer(gltf, values);
  return gltf;
}

inline nlohmann::json morphing_leg(const Morphing& with = {}) {
  std::vector<float> values;
  return morphing_leg(with, values);
}

}  // namespace sinew::import::test
