#include "import/gltf_document.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "import/gltf_floats.h"
#include "import/plain_words.h"
#include "import/readers.h"

namespace sinew::import {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  ///< "JSON", little-endian

std::uint32_t word_at(const std::string& content, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, content.data() + at, sizeof word);
  return word;
}

std::string as_bytes(std::uint32_t word) {
  return {reinterpret_cast<const char*>(&word), sizeof word};
}

/// Length of the JSON chunk of a GLB.
std::size_t json_length(const std::string& content) {
  if (content.size() < kHeader + kChunkHeader) throw std::runtime_error("the GLB ends within its header");
  if (word_at(content, 4) != 2)
    throw std::runtime_error("GLB version " + std::to_string(word_at(content, 4)) + "; only 2 can be read");
  if (word_at(content, 8) > content.size())
    throw std::runtime_error("the GLB is cut off: " + std::to_string(content.size()) + " of " +
                             std::to_string(word_at(content, 8)) + " bytes");
  const std::size_t length = word_at(content, kHeader);
  if (word_at(content, kHeader + 4) != kJsonChunk || length > content.size() - kHeader - kChunkHeader)
    throw std::runtime_error("the GLB does not begin with a whole JSON chunk");
  return length;
}

void check_version(const Json& document) {
  const Json& asset = document.at("asset");
  if (!asset.contains("version")) return;  // assimp's message will do
  const Json& version = asset.at("version");
  if (!version.is_string() || version.get<std::string>().rfind("2.", 0) != 0)
    throw std::runtime_error("glTF version " + version.dump() + "; only 2 can be read");
}

/// What is required may still only touch the looks.
void check_extensions(const Json& document) {
  if (!document.contains("extensionsRequired")) return;
  for (const Json& extension : document.at("extensionsRequired")) {
    const std::string name = extension.get<std::string>();
    bool looks = false;
    for (const char* prefix : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"})
      looks = looks || name.rfind(prefix, 0) == 0;
    if (!looks) throw std::runtime_error("it needs the extension " + name + ", which cannot be read");
  }
}

std::size_t index_in(const Json& owner, const char* key, std::size_t count, const std::string& where) {
  const Json& value = owner.at(key);
  if (!value.is_number_unsigned() || value.get<std::size_t>() >= count)
    throw std::runtime_error(where + ": '" + key + "' points nowhere");
  return value.get<std::size_t>();
}

std::size_t length_of(const Json& document, const char* key) {
  return document.contains(key) ? document.at(key).size() : 0;
}

/// Every node has at most one parent and hangs, not too deep, on one that has none.
void check_tree(const Json& nodes, const ReadLimits& limits) {
  if (nodes.size() > static_cast<std::size_t>(limits.max_nodes)) throw std::runtime_error("too many nodes");
  std::vector<bool> has_parent(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (!nodes[k].contains("children")) continue;
    for (const Json& child : nodes[k].at("children")) {
      const std::string where = "node " + std::to_string(k);
      if (!child.is_number_unsigned() || child.get<std::size_t>() >= nodes.size())
        throw std::runtime_error(where + ": a child points nowhere");
      if (has_parent[child.get<std::size_t>()])
        throw std::runtime_error("node " + std::to_string(child.get<std::size_t>()) + " has two parents");
      has_parent[child.get<std::size_t>()] = true;
    }
  }
  struct Open {
    std::size_t node;
    int depth;
  };
  std::vector<Open> stack;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (!has_parent[k]) stack.push_back({k, 1});
  std::size_t reached = 0;
  while (!stack.empty()) {
    const Open open = stack.back();
    stack.pop_back();
    ++reached;
    if (open.depth > limits.max_depth) throw std::runtime_error("nodes are nested too deeply");
    if (!nodes[open.node].contains("children")) continue;
    for (const Json& child : nodes[open.node].at("children"))
      stack.push_back({child.get<std::size_t>(), open.depth + 1});
  }
  if (reached != nodes.size()) throw std::runtime_error("nodes form a loop");
}

/// assimp 5.2.5 reads a matrix for each joint, whatever there is.
void check_skins(const Json& document) {
  const Json& skins = document.at("skins");
  for (std::size_t k = 0; k < skins.size(); ++k) {
    const std::string where = "skin " + std::to_string(k);
    const Json& joints = skins[k].at("joints");
    for (const Json& joint : joints)
      if (!joint.is_number_unsigned() || joint.get<std::size_t>() >= length_of(document, "nodes"))
        throw std::runtime_error(where + ": a joint points nowhere");
    if (!skins[k].contains("inverseBindMatrices")) continue;
    const Json& binds =
        document.at("accessors")
            .at(index_in(skins[k], "inverseBindMatrices", length_of(document, "accessors"), where));
    if (binds.value("type", "") != "MAT4" || binds.value("count", std::size_t(0)) < joints.size())
      throw std::runtime_error(where + ": not a bind matrix for each of its joints");
  }
}

/// How many morph targets the mesh has that an animation's target moves; 0 where it moves none.
std::size_t morph_targets_of(const Json& document, const Json& target, const std::string& where) {
  if (!target.contains("node")) return 0;
  const Json& node = document.at("nodes").at(target.at("node").get<std::size_t>());
  if (!node.contains("mesh")) return 0;
  const Json& mesh = document.at("meshes").at(index_in(node, "mesh", length_of(document, "meshes"), where));
  const Json& primitives = mesh.at("primitives");
  return primitives.empty() ? 0 : length_of(primitives.at(0), "targets");
}

/// "/nodes/7/rotation" of KHR_animation_pointer becomes the target of an ordinary channel; what points at
/// something else stays.
void resolve_pointer(Json& target) {
  std::istringstream pointer(target.value("extensions", Json::object())
                                 .value("KHR_animation_pointer", Json::object())
                                 .value("pointer", ""));
  std::string start, list, path, rest;
  std::size_t node = 0;
  std::getline(pointer, start, '/');
  std::getline(pointer, list, '/');
  if (!start.empty() || list != "nodes" || !(pointer >> node) || pointer.get() != '/') return;
  std::getline(pointer, path, '/');
  if (!std::getline(pointer, rest)) target = {{"node", node}, {"path", path}};
}

/// assimp reads one scene; notes nodes that are not in it.
void note_other_scenes(const Json& document, std::vector<std::string>& notes) {
  if (length_of(document, "scenes") == 0) return;
  const Json& scenes = document.at("scenes");
  const std::size_t scene =
      document.contains("scene") ? index_in(document, "scene", scenes.size(), "file") : 0;
  const Json& nodes = document.at("nodes");
  std::vector<bool> seen(nodes.size());
  std::vector<Json> open;
  if (scenes[scene].contains("nodes"))
    open.assign(scenes[scene]["nodes"].begin(), scenes[scene]["nodes"].end());
  while (!open.empty()) {
    const Json node = open.back();
    open.pop_back();
    if (!node.is_number_unsigned() || node.get<std::size_t>() >= nodes.size()) continue;  // assimp refuses it
    const std::size_t k = node.get<std::size_t>();
    if (seen[k]) continue;
    seen[k] = true;
    if (nodes[k].contains("children"))
      open.insert(open.end(), nodes[k]["children"].begin(), nodes[k]["children"].end());
  }
  if (const auto others = std::count(seen.begin(), seen.end(), false); others > 0)
    notes.push_back(std::to_string(others) + (others == 1 ? " node is" : " nodes are") +
                    " not in the file's default scene; left out");
}

/// Leaves only channels that move a node: assimp 5.2.5 takes what has no target for one of some node.
void drop_untargeted_channels(Json& animation, const std::string& where, std::vector<std::string>& notes) {
  Json kept = Json::array();
  Json& channels = animation.at("channels");
  for (Json& channel : channels) {
    Json& target = channel.at("target");
    if (target.value("path", "") == "pointer") resolve_pointer(target);
    const std::string path = target.value("path", "");
    if (target.contains("node") &&
        (path == "translation" || path == "rotation" || path == "scale" || path == "weights"))
      kept.push_back(std::move(channel));
  }
  if (const std::size_t dropped = channels.size() - kept.size(); dropped > 0)
    notes.push_back(where + ": " + std::to_string(dropped) +
                    (dropped == 1 ? " channel moves" : " channels move") + " no node, not read");
  channels = std::move(kept);
}

/// assimp 5.2.5 gives a mesh the skin of whichever of its nodes comes last, and does not read a node's own
/// weights of morph targets: each skin takes a copy, and so do such weights, which become the copy's.
void part_shared_meshes(Json& document) {
  if (!document.contains("meshes")) return;
  Json& meshes = document.at("meshes");
  const std::size_t count = meshes.size(), none = length_of(document, "skins");
  std::map<std::tuple<std::size_t, std::size_t, std::string>, std::size_t> copies;  // with skin, weights
  std::vector<bool> taken(count);
  Json& nodes = document.at("nodes");
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Json& node = nodes[k];
    if (!node.contains("mesh")) continue;
    const std::string where = "node " + std::to_string(k);
    const std::size_t mesh = index_in(node, "mesh", count, where);
    const std::size_t skin = node.contains("skin") ? index_in(node, "skin", none, where) : none;
    const bool own_weights = node.contains("weights") && node.at("weights").is_array();
    const auto [found, fresh] =
        copies.try_emplace({mesh, skin, own_weights ? node.at("weights").dump() : ""}, mesh);
    if (fresh && (taken[mesh] || own_weights)) {
      found->second = meshes.size();
      meshes.push_back(Json(meshes[mesh]));
      if (own_weights) meshes.back()["weights"] = node.at("weights");
    }
    taken[mesh] = taken[mesh] || !own_weights;
    node["mesh"] = found->second;
  }
}

void check_animation(const Json& document, const Json& animation, const std::string& where) {
  static const Json kNone = Json::array();
  const Json& samplers = animation.at("samplers");
  const Json& accessors = document.contains("accessors") ? document.at("accessors") : kNone;
  for (const Json& channel : animation.at("channels")) {
    const Json& sampler = samplers[index_in(channel, "sampler", samplers.size(), where)];
    const Json& target = channel.at("target");
    if (target.contains("node")) index_in(target, "node", length_of(document, "nodes"), where);
    const Json& input = accessors[index_in(sampler, "input", accessors.size(), where)];
    const Json& output = accessors[index_in(sampler, "output", accessors.size(), where)];
    std::size_t per_key = sampler.value("interpolation", "LINEAR") == "CUBICSPLINE" ? 3 : 1;
    if (target.value("path", "") == "weights") {
      if (input.at("count").get<std::size_t>() == 0)  // assimp divides by it
        throw std::runtime_error(where + ": weights without keys");
      per_key *= morph_targets_of(document, target, where);
      if (per_key == 0) continue;  // noted when the clip is read
    }
    if (output.at("count").get<std::size_t>() != per_key * input.at("count").get<std::size_t>())
      throw std::runtime_error(where + ": key times and values differ in number");
  }
}

/// assimp 5.2.5 reads every curve as straight lines between its keys.
void note_curves(const Json& animation, const std::string& where, std::vector<std::string>& notes) {
  int steps = 0, cubics = 0;
  for (const Json& sampler : animation.at("samplers")) {
    const std::string interpolation = sampler.value("interpolation", "LINEAR");
    steps += interpolation == "STEP";
    cubics += interpolation == "CUBICSPLINE";
  }
  if (steps > 0) notes.push_back(where + ": " + std::to_string(steps) + " stepped curves read as lines");
  if (cubics > 0) notes.push_back(where + ": " + std::to_string(cubics) + " cubic curves read as lines");
}

/// "my%20skin.png" → "my skin.png"; assimp 5.2.5 asks for the name as it stands.
std::string percent_decoded(const std::string& uri) {
  std::string out;
  for (std::size_t at = 0; at < uri.size(); ++at) {
    const auto digit = [&](std::size_t i) { return std::isxdigit(static_cast<unsigned char>(uri[i])); };
    const bool coded = uri[at] == '%' && at + 2 < uri.size() && digit(at + 1) && digit(at + 2);
    out += coded ? static_cast<char>(std::stoi(uri.substr(at + 1, 2), nullptr, 16)) : uri[at];
    if (coded) at += 2;
  }
  return out;
}

void decode_uris(Json& document) {
  for (const char* list : {"buffers", "images"}) {
    if (!document.contains(list)) continue;
    for (Json& item : document.at(list)) {
      const std::string uri = item.value("uri", "");
      if (!uri.empty() && uri.rfind("data:", 0) != 0) item["uri"] = percent_decoded(uri);
    }
  }
}

/// What the author of a file added to something in it, as JSON.
std::string extras_of(const Json& owner) {
  return owner.contains("extras") ? owner.at("extras").dump(-1, ' ', false, Json::error_handler_t::replace)
                                  : std::string();
}

using ReadBeside = std::function<std::string(const std::string& name)>;

/// Of a GLB, what follows its JSON: one more chunk at most.
std::string binary_chunk(const std::string& rest) {
  if (rest.size() < kChunkHeader) return {};
  return rest.substr(kChunkHeader, std::min<std::size_t>(word_at(rest, 0), rest.size() - kChunkHeader));
}

/// Up to the first letter that is none of base64's.
std::string from_base64(std::string_view text) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    const std::size_t value = kLetters.find(letter);
    if (value == std::string_view::npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

std::string buffer_bytes(const Json& document, std::size_t number, const std::string& rest,
                         const ReadBeside& read_beside) {
  constexpr std::string_view kData = "data:";
  const std::string uri = document.at("buffers").at(number).value("uri", "");
  if (uri.empty()) return binary_chunk(rest);
  if (uri.rfind(kData, 0) != 0) return read_beside(uri);
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos)
    throw std::runtime_error("buffer " + std::to_string(number) + " has a data URI that is not base64");
  return from_base64(std::string_view(uri).substr(comma + 1));
}

GltfDocument prepare(const std::string& content, bool binary, const ReadLimits& limits,
                     const ReadBeside& read_beside) {
  const std::size_t begin = binary ? kHeader + kChunkHeader : 0;
  const std::size_t length = binary ? json_length(content) : content.size();
  const std::string_view text(content.data() + begin, length);
  check_json_nesting(text);
  Json document = Json::parse(text);
  check_version(document);
  check_extensions(document);
  GltfDocument out;
  out.extras = extras_of(document);
  if (document.contains("nodes")) {
    Json& nodes = document.at("nodes");
    check_tree(nodes, limits);
    note_other_scenes(document, out.notes);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      out.node_names.push_back(nodes[k].value("name", ""));
      nodes[k]["name"] = node_tag(k);
      if (nodes[k].contains("matrix")) continue;
      // Else assimp 5.2.5 takes a matrix apart for what an animation leaves alone: all axes mirrored or none.
      nodes[k].emplace("translation", Json::array({0, 0, 0}));
      nodes[k].emplace("rotation", Json::array({0, 0, 0, 1}));
      nodes[k].emplace("scale", Json::array({1, 1, 1}));
    }
    part_shared_meshes(document);
  }
  if (document.contains("animations")) {
    Json& animations = document.at("animations");
    for (std::size_t a = 0; a < animations.size(); ++a) {
      const std::string where = "animation " + std::to_string(a);
      drop_untargeted_channels(animations[a], where, out.notes);
      check_animation(document, animations[a], where);
      note_curves(animations[a], where, out.notes);
      out.animation_extras.push_back(extras_of(animations[a]));
    }
  }
  decode_uris(document);
  const std::string rest = content.substr(begin + length);
  if (document.contains("skins")) check_skins(document);
  out.floats = add_floats(
      document, [&](std::size_t k) { return buffer_bytes(document, k, rest, read_beside); }, kFloatsFile,
      limits);
  out.content = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (binary) {
    out.content.resize((out.content.size() + 3) / 4 * 4, ' ');
    const std::size_t total = begin + out.content.size() + rest.size();
    out.content = "glTF" + as_bytes(2) + as_bytes(static_cast<std::uint32_t>(total)) +
                  as_bytes(static_cast<std::uint32_t>(out.content.size())) + as_bytes(kJsonChunk) +
                  out.content + rest;
  }
  return out;
}

}  // namespace

std::string node_tag(std::size_t k) {
  return "node_" + std::to_string(k);
}

GltfDocument prepare_gltf(const std::string& content, bool binary, const ReadLimits& limits,
                          const ReadBeside& read_beside) {
  try {
    return prepare(content, binary, limits, read_beside);
  } catch (const Json::parse_error& e) {
    throw std::runtime_error("its JSON is damaged at byte " + std::to_string(e.byte));
  } catch (const Json::exception& e) {
    throw std::runtime_error("its glTF structure is wrong: " + plain_words(e));
  }
}

}  // namespace sinew::import
