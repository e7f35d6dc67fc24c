#include "export/gltf_file.h"

#include <algorithm>
#include <limits>

namespace sinew::exporting {
namespace {

using nlohmann::json;

constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;  // component types
constexpr int kVertexData = 34962, kIndexData = 34963;                    // targets of buffer views

std::size_t components(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "MAT4") return 16;
  return static_cast<std::size_t>(type.back() - '0');
}

std::string base64(const std::string& bytes) {
  static const char* const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto at = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i])) : 0u;
  };
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned word = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (const int shift : {18, 12, 6, 0}) out += letters[word >> shift & 63];
  }
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  out.replace(out.size() - padding, padding, padding, '=');
  return out;
}

std::string little_endian(std::size_t value) {
  std::string out;
  for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> 8 * k & 255);
  return out;
}

}  // namespace

int GltfFile::add(const char* list, json item) {
  json& all = document[list];
  all.push_back(std::move(item));
  return static_cast<int>(all.size()) - 1;
}

int GltfFile::add_view(const void* data, std::size_t size, int target) {
  buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
  nlohmann::json view = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", size}};
  if (target != 0) view["target"] = target;
  buffer_.append(static_cast<const char*>(data), size);
  return add("bufferViews", view);
}

int GltfFile::add_accessor(int view, int component_type, std::size_t count, const char* type) {
  return add("accessors",
             {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
}

int GltfFile::add_numbers(std::span<const float> values, const char* type, Use use, bool bounded) {
  const std::size_t width = components(type);
  const int view = add_view(values.data(), values.size_bytes(), use == Use::kVertices ? kVertexData : 0);
  const int accessor = add_accessor(view, kFloat, values.size() / width, type);
  if (bounded) {
    constexpr float kMost = std::numeric_limits<float>::max();
    set_bounds(accessor, values, std::vector<float>(width, kMost), std::vector<float>(width, -kMost));
  }
  return accessor;
}

void GltfFile::set_bounds(int accessor, std::span<const float> values, std::vector<float> least,
                          std::vector<float> greatest) {
  const std::size_t width = least.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    least[i % width] = std::min(least[i % width], values[i]);
    greatest[i % width] = std::max(greatest[i % width], values[i]);
  }
  document["accessors"][static_cast<std::size_t>(accessor)].update({{"min", least}, {"max", greatest}});
}

int GltfFile::add_sparse(std::span<const std::uint32_t> at, std::span<const float> values,
                         std::size_t count) {
  json indices = {{"bufferView", add_view(at.data(), at.size_bytes(), 0)}, {"componentType", kUnsignedInt}};
  json numbers = {{"bufferView", add_view(values.data(), values.size_bytes(), 0)}};
  const int accessor =
      add("accessors", {{"componentType", kFloat},
                        {"count", count},
                        {"type", "VEC3"},
                        {"sparse", {{"count", at.size()}, {"indices", indices}, {"values", numbers}}}});
  const bool everywhere = at.size() == count;  // else some are zero
  constexpr float kMost = std::numeric_limits<float>::max();
  set_bounds(accessor, values, std::vector<float>(3, everywhere ? kMost : 0),
             std::vector<float>(3, everywhere ? -kMost : 0));
  return accessor;
}

int GltfFile::add_joints(std::span<const std::uint16_t> joints) {
  return add_accessor(add_view(joints.data(), joints.size_bytes(), kVertexData), kUnsignedShort,
                      joints.size() / 4, "VEC4");
}

int GltfFile::add_triangles(std::span<const std::uint32_t> indices) {
  const auto most = std::max_element(indices.begin(), indices.end());
  if (most == indices.end() || *most >= 65535)  // which restarts a strip
    return add_accessor(add_view(indices.data(), indices.size_bytes(), kIndexData), kUnsignedInt,
                        indices.size(), "SCALAR");
  std::vector<std::uint16_t> narrow;
  for (const std::uint32_t i : indices) narrow.push_back(static_cast<std::uint16_t>(i));
  return add_accessor(add_view(narrow.data(), 2 * narrow.size(), kIndexData), kUnsignedShort, narrow.size(),
                      "SCALAR");
}

int GltfFile::add_bytes(std::span<const std::uint8_t> bytes) {
  return add_view(bytes.data(), bytes.size(), 0);
}

std::string GltfFile::text() const {
  return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string GltfFile::as_glb() const {
  GltfFile whole = *this;
  whole.buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
  whole.document["buffers"] = {{{"byteLength", whole.buffer_.size()}}};
  std::string text = whole.text();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string& binary = whole.buffer_;
  return "glTF" + little_endian(2) + little_endian(12 + 8 + text.size() + 8 + binary.size()) +
         little_endian(text.size()) + "JSON" + text + little_endian(binary.size()) + std::string("BIN\0", 4) +
         binary;
}

std::string GltfFile::as_gltf() const {
  GltfFile whole;
  whole.document = document;
  whole.document["buffers"] = {
      {{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}};
  return whole.text() + "\n";
}

}  // namespace sinew::exporting
