#include "import/gltf_floats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>

namespace sinew::import {
namespace {

using Json = nlohmann::json;

enum Component { kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kFloat = 5126 };

std::size_t bytes_of_component(int component) {
  switch (component) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    default:
      return 0;
  }
}

std::size_t components_of(const std::string& type) {
  static const std::map<std::string, std::size_t> kCounts = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  const auto found = kCounts.find(type);
  return found == kCounts.end() ? 0 : found->second;
}

/// Section 3.11 of the specification.
float widened(const char* at, int component) {
  std::uint16_t bits = 0;
  std::memcpy(&bits, at, bytes_of_component(component));
  switch (component) {
    case kByte:
      return std::max(float(static_cast<std::int8_t>(bits)) / 127.f, -1.f);
    case kUnsignedByte:
      return float(bits) / 255.f;
    case kShort:
      return std::max(float(static_cast<std::int16_t>(bits)) / 32767.f, -1.f);
    default:
      return float(bits) / 65535.f;
  }
}

/// Weights are normalised whether or not the file says so.
std::set<std::size_t> weight_accessors(const Json& document) {
  std::set<std::size_t> found;
  for (const Json& mesh : document.value("meshes", Json::array()))
    for (const Json& primitive : mesh.value("primitives", Json::array())) {
      const Json attributes = primitive.value("attributes", Json::object());
      for (const auto& [name, accessor] : attributes.items())
        if (name.rfind("WEIGHTS_", 0) == 0) found.insert(accessor.get<std::size_t>());
    }
  return found;
}

class Widening {
 public:
  Widening(Json& document, const std::function<std::string(std::size_t)>& bytes_of, const ReadLimits& limits)
      : document_(document), bytes_of_(bytes_of), limits_(limits) {}

  std::string run(const std::string& file) {
    const std::set<std::size_t> weights = weight_accessors(document_);
    Json& accessors = document_.at("accessors");
    for (std::size_t k = 0; k < accessors.size(); ++k) {
      Json& accessor = accessors[k];
      const int component = accessor.value("componentType", 0);
      const std::size_t components = components_of(accessor.value("type", ""));
      if (bytes_of_component(component) == 0 || components == 0) continue;
      if (accessor.value("normalized", false) || weights.count(k) > 0)
        widen(accessor, "accessor " + std::to_string(k), component, components);
    }
    if (document_.contains("skins"))
      for (Json& skin : document_.at("skins"))
        if (!skin.contains("inverseBindMatrices")) bind_as_modelled(skin);
    if (!floats_.empty()) document_.at("buffers").push_back({{"byteLength", floats_.size()}, {"uri", file}});
    return std::move(floats_);
  }

 private:
  void widen(Json& accessor, const std::string& what, int component, std::size_t components) {
    if (accessor.contains("sparse"))
      throw std::runtime_error(what + " is sparse and normalised, which cannot be read");
    const std::size_t count = accessor.value("count", std::size_t(0)), size = bytes_of_component(component);
    const std::size_t begin = floats_.size();
    if (!accessor.contains("bufferView")) return;  // zeros
    const Json& view = document_.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const std::string& bytes = buffer(view.at("buffer").get<std::size_t>());
    const std::size_t stride = view.value("byteStride", size * components),
                      first = view.value("byteOffset", std::size_t(0)),
                      length = view.at("byteLength").get<std::size_t>(),
                      offset = accessor.value("byteOffset", std::size_t(0));
    if (first > bytes.size() || length > bytes.size() - first)
      throw std::runtime_error(what + " has a view that reaches beyond its buffer");
    if (stride < size * components || offset > length || count > length / stride + 1 ||
        (count > 0 && (length - offset) < (count - 1) * stride + size * components))
      throw std::runtime_error(what + " reaches beyond its view");
    if (begin + count * components * sizeof(float) > limits_.max_file_bytes)
      throw std::runtime_error(what + " is too large");
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < components; ++c)
        append(widened(bytes.data() + first + offset + i * stride + c * size, component));
    accessor["bufferView"] = document_.at("bufferViews").size();
    accessor["componentType"] = int(kFloat);
    for (const char* key : {"normalized", "byteOffset", "min", "max"}) accessor.erase(key);
    add_view(begin);
  }

  /// Its mesh was modelled in each joint's own frame: a matrix of 1 for each.
  void bind_as_modelled(Json& skin) {
    const std::size_t begin = floats_.size(), joints = skin.at("joints").size();
    for (std::size_t k = 0; k < joints; ++k)
      for (int entry = 0; entry < 16; ++entry) append(entry % 5 == 0 ? 1.f : 0.f);
    skin["inverseBindMatrices"] = document_.at("accessors").size();
    document_.at("accessors")
        .push_back({{"bufferView", document_["bufferViews"].size()},
                    {"componentType", int(kFloat)},
                    {"count", joints},
                    {"type", "MAT4"}});
    add_view(begin);
  }

  void append(float value) {
    const auto raw = std::bit_cast<std::array<char, sizeof value>>(value);
    floats_.append(raw.data(), raw.size());
  }

  /// Of the floats from `begin` on.
  void add_view(std::size_t begin) {
    document_["bufferViews"].push_back({{"buffer", document_.at("buffers").size()},
                                        {"byteOffset", begin},
                                        {"byteLength", floats_.size() - begin}});
  }

  const std::string& buffer(std::size_t number) {
    const auto known = buffers_.find(number);
    return known != buffers_.end() ? known->second : buffers_[number] = bytes_of_(number);
  }

  Json& document_;
  const std::function<std::string(std::size_t)>& bytes_of_;
  const ReadLimits& limits_;
  std::map<std::size_t, std::string> buffers_;
  std::string floats_;
};

}  // namespace

std::string add_floats(Json& document, const std::function<std::string(std::size_t)>& bytes_of,
                       const std::string& file, const ReadLimits& limits) {
  if (!document.contains("accessors") || !document.contains("buffers")) return {};
  return Widening(document, bytes_of, limits).run(file);
}

}  // namespace sinew::import
