// Reads content or files through the whole importer, and small documents to feed it with.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "import/source_scene.h"

namespace sinew::import::test {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kConfined = false;  ///< the sandbox's memory limit and call filter are off under the sanitizer
#else
constexpr bool kConfined = true;
#endif

/// A directory of its own, removed at the end.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sinew_import_XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary directory");
    directory_ = pattern;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { std::filesystem::remove_all(directory_); }
  std::filesystem::path path(const std::string& name) const { return directory_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::filesystem::path file = path(name);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  std::filesystem::path directory_;
};

struct Outcome {
  bool ok = false;
  SourceScene scene;
  std::string error;
  double seconds = 0;
};

inline Outcome read(const std::filesystem::path& file, const ReadLimits& limits = {}) {
  Outcome outcome;
  const auto start = std::chrono::steady_clock::now();
  outcome.ok = read_source(file.string(), limits, outcome.scene, outcome.error);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

inline Outcome read_content(const std::string& name, const std::string& content,
                            const ReadLimits& limits = {}) {
  const Scratch scratch;
  return read(scratch.write(name, content), limits);
}

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline int index_of(const SourceScene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].name == name) return static_cast<int>(i);
  return -1;
}

inline std::string repeated(const std::string& piece, int times) {
  std::string all;
  all.reserve(piece.size() * static_cast<std::size_t>(times));
  for (int i = 0; i < times; ++i) all += piece;
  return all;
}

inline std::string base64(const std::vector<float>& values) {
  static const char* const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes(values.size() * sizeof(float));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  bytes.resize(bytes.size() + padding);
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned word = unsigned(bytes[i]) << 16 | unsigned(bytes[i + 1]) << 8 | bytes[i + 2];
    for (const int shift : {18, 12, 6, 0}) text += letters[word >> shift & 63];
  }
  text.replace(text.size() - padding, padding, padding, '=');
  return text;
}

/// Appends values to what will be the document's only buffer; returns the accessor that reads them.
inline std::size_t append(nlohmann::json& gltf, std::vector<float>& values, const std::vector<float>& more,
                          const char* type, int count, int component_type = 5126) {
  const std::size_t view = gltf["bufferViews"].size(), accessor = gltf["accessors"].size();
  gltf["bufferViews"].push_back({{"buffer", 0},
                                 {"byteOffset", values.size() * sizeof(float)},
                                 {"byteLength", more.size() * sizeof(float)}});
  gltf["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  values.insert(values.end(), more.begin(), more.end());
  return accessor;
}

/// Puts `values` into the document's only buffer.
inline void set_buffer(nlohmann::json& gltf, const std::vector<float>& values) {
  gltf["buffers"][0] = {{"byteLength", values.size() * sizeof(float)},
                        {"uri", "data:application/octet-stream;base64," + base64(values)}};
}

/// Key times and rotations of kicking_leg().
inline std::vector<float> kick_keys() {
  return {0, 0.5f, 1, 0, 0, 0, 1, 0.38268343f, 0, 0, 0.92387953f, 0.70710678f, 0, 0, 0.70710678f};
}

/// Corners of the triangle of with_triangle().
inline std::vector<float> corners() {
  return {0, 0, 0, 1, 0, 0, 0, 1, 0};
}

inline std::vector<float> kick_keys_and_corners() {
  std::vector<float> values = kick_keys();
  for (const float x : corners()) values.push_back(x);
  return values;
}

/// Hip with a leg below, and a clip "kick" that turns the leg by 0°, 45° and 90° about X at 0, 0.5 and 1 s.
inline nlohmann::json kicking_leg() {
  nlohmann::json gltf = nlohmann::json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"name": "hip", "children": [1], "translation": [0, 1, 0]},
              {"name": "leg", "translation": [0, -0.5, 0]}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 12},
                    {"buffer": 0, "byteOffset": 12, "byteLength": 48}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [1]},
                  {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC4"}],
    "animations": [{"name": "kick", "samplers": [{"input": 0, "output": 1}],
                    "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}]}]})");
  set_buffer(gltf, kick_keys());
  return gltf;
}

/// The same, with a triangle on the node `carrier`.
inline nlohmann::json with_triangle(nlohmann::json gltf, int carrier) {
  std::vector<float> values = kick_keys();
  const std::size_t accessor = append(gltf, values, corners(), "VEC3", 3);
  gltf["accessors"][accessor].update({{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
  set_buffer(gltf, values);
  gltf["meshes"] = nlohmann::json::parse(R"([{"name": "skirt", "primitives": [{"attributes": {}}]}])");
  gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = accessor;
  gltf["nodes"][carrier]["mesh"] = 0;
  return gltf;
}

/// GLB of a document and what belongs into its only buffer.
inline std::string as_glb(nlohmann::json gltf, const std::vector<float>& values) {
  gltf["buffers"][0] = {{"byteLength", values.size() * sizeof(float)}};
  std::string json = gltf.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string bin(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  const auto word = [](std::size_t value) {
    const auto v = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&v), sizeof v);
  };
  return "glTF" + word(2) + word(12 + 8 + json.size() + 8 + bin.size()) + word(json.size()) + "JSON" + json +
         word(bin.size()) + std::string("BIN\0", 4) + bin;
}

/// Two joints and an end site; `motion` is what follows "MOTION".
inline std::string short_bvh(const std::string& motion) {
  return "HIERARCHY\nROOT hip\n{\n  OFFSET 0 0 0\n"
         "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
         "  JOINT leg\n  {\n    OFFSET 0 -40 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
         "    End Site\n    {\n      OFFSET 0 -40 0\n    }\n  }\n}\nMOTION\n" +
         motion;
}

inline std::string walking_bvh() {
  return short_bvh("Frames: 2\nFrame Time: 0.02\n0 90 0 0 0 0 0 0 0\n1 90 0 0 0 0 0 90 0\n");
}

/// Two links and the joint `joint` between them.
inline std::string short_urdf(const std::string& joint, const std::string& inside_link = "") {
  return "<?xml version=\"1.0\"?><robot name=\"r\"><link name=\"a\">" + inside_link +
         "</link><link name=\"b\"/>" + joint + "</robot>";
}

inline std::string knee(const std::string& inside = "", const std::string& type = "revolute") {
  return "<joint name=\"knee\" type=\"" + type + "\"><parent link=\"a\"/><child link=\"b\"/>" + inside +
         "</joint>";
}

inline const char* const kGoodLimit = "<limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"5\"/>";

}  // namespace sinew::import::test
