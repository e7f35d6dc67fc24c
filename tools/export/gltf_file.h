// A glTF 2.0 document under construction: its JSON, and the one buffer that its accessors read.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace sinew::exporting {

class GltfFile {
 public:
  enum class Use { kVertices, kOther };  ///< what a buffer view says that it is for

  nlohmann::json document = nlohmann::json::object();

  /// Appends to an array of the document, and says at which index.
  int add(const char* list, nlohmann::json item);

  /// Accessors of numbers; `type` is SCALAR, VEC2, VEC3, VEC4 or MAT4. `bounded`: with its least and greatest
  /// values, as positions and key times must be.
  int add_numbers(std::span<const float> values, const char* type, Use use, bool bounded = false);
  /// The same of `count` vectors of three numbers, of which those `at` rising places are not zero.
  int add_sparse(std::span<const std::uint32_t> at, std::span<const float> values, std::size_t count);
  int add_joints(std::span<const std::uint16_t> joints);      ///< [vertex][4]
  int add_triangles(std::span<const std::uint32_t> indices);  ///< of 16 bits where that is enough
  /// Bytes of a file, such as a texture's.
  int add_bytes(std::span<const std::uint8_t> bytes);

  /// The whole file: GLB, or JSON with the buffer within it.
  std::string as_glb() const;
  std::string as_gltf() const;

 private:
  int add_view(const void* data, std::size_t size, int target);
  /// The least and the greatest of values, and of those given.
  void set_bounds(int accessor, std::span<const float> values, std::vector<float> least,
                  std::vector<float> greatest);
  int add_accessor(int view, int component_type, std::size_t count, const char* type);
  std::string text() const;

  std::string buffer_;
};

}  // namespace sinew::exporting
