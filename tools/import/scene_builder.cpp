#include "import/scene_builder.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "import/fbx_pivots.h"
#include "import/text.h"

namespace sinew::import {
namespace {

constexpr double kTicksWhenUnknown = 25;  ///< 1/s, what assimp's own viewer takes

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned r = 0; r < 4; ++r)
    for (unsigned c = 0; c < 4; ++c) out(r, c) = double(m[r][c]);
  return out;
}

Eigen::Quaterniond value_of(const aiQuaternion& q) {
  return Eigen::Quaterniond(double(q.w), double(q.x), double(q.y), double(q.z)).normalized();
}

Eigen::Vector3d value_of(const aiVector3D& v) {
  return {double(v.x), double(v.y), double(v.z)};
}

/// Copies keys whose times rise; the first of equal ones stays. Returns how many did not rise.
template <class Key, class V>
int copy_keys(const Key* keys, unsigned count, double ticks, std::vector<double>& times,
              std::vector<V>& values) {
  int dropped = 0;
  for (unsigned k = 0; k < count; ++k) {
    const double t = keys[k].mTime / ticks;
    if (!std::isfinite(t)) throw std::runtime_error("a key time is not finite");
    if (!times.empty() && t <= times.back()) {
      ++dropped;
      continue;
    }
    times.push_back(t);
    values.push_back(value_of(keys[k].mValue));
  }
  return dropped;
}

template <class Visit>
void for_each_track(SourceClip& clip, Visit visit) {
  for (SourceChannel& c : clip.channels)
    for (auto* times : {&c.position_times, &c.rotation_times, &c.scale_times})
      if (!times->empty()) visit(*times);
  for (SourceMorphChannel& c : clip.morphs)
    if (!c.times.empty()) visit(c.times);
}

/// 1/s, of the track with the closest keys by its median interval; 0 when no track has two.
double key_rate(SourceClip& clip) {
  double rate = 0;
  std::vector<double> intervals;
  for_each_track(clip, [&](const std::vector<double>& times) {
    if (times.size() < 2) return;
    intervals.resize(times.size());
    std::adjacent_difference(times.begin(), times.end(), intervals.begin());  // its first is no interval
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>((intervals.size() + 1) / 2);
    std::nth_element(intervals.begin() + 1, middle, intervals.end());
    rate = std::max(rate, 1 / *middle);
  });
  return rate;
}

/// What a morph target does to the vertices of its mesh.
SourceMesh::Morph morph_of(const aiMesh& mesh, const aiAnimMesh& target, bool fbx) {
  SourceMesh::Morph morph;
  morph.name = clean_text(target.mName.C_Str());
  morph.weight = fbx ? 0 : target.mWeight;  // assimp 5.2.5 says 1 of each of FBX's
  const auto differences = [&](const aiVector3D* to, const aiVector3D* from,
                               std::vector<std::array<float, 3>>& out) {
    for (unsigned v = 0; to && from && v < mesh.mNumVertices; ++v) {
      const aiVector3D d = to[v] - from[v];
      out.push_back({d.x, d.y, d.z});
    }
  };
  differences(target.mVertices, mesh.mVertices, morph.moves);
  differences(target.mNormals, mesh.mNormals, morph.tilts);
  return morph;
}

/// Where keys say nothing of a target (NaN), the line between those before and after; its weight at rest
/// where none does.
void fill_gaps(const SourceMesh& mesh, SourceMorphChannel& channel) {
  const std::size_t count = mesh.morphs.size(), keys = channel.times.size();
  for (std::size_t m = 0; m < count; ++m) {
    const auto weight = [&](std::size_t k) -> float& { return channel.weights[k * count + m]; };
    std::size_t last = keys;  // the last key that is known
    for (std::size_t k = 0; k < keys; ++k) {
      if (std::isnan(weight(k))) continue;
      for (std::size_t gap = last == keys ? 0 : last + 1; gap < k; ++gap) {
        const double from = channel.times[last == keys ? k : last], to = channel.times[k];
        const double part = last == keys ? 1 : (channel.times[gap] - from) / (to - from);
        const float before = weight(last == keys ? k : last);
        weight(gap) = before + static_cast<float>(part) * (weight(k) - before);
      }
      last = k;
    }
    for (std::size_t k = last == keys ? 0 : last + 1; k < keys; ++k)
      weight(k) = last == keys ? mesh.morphs[m].weight : weight(last);
  }
}

/// What keys say of each target of a mesh. glTF's say it of all, FBX' of those alone that have a key then.
SourceMorphChannel morph_channel_of(const aiMeshMorphAnim& in, const SourceMesh& mesh, double ticks,
                                    const std::string& clip) {
  const std::size_t count = mesh.morphs.size();
  SourceMorphChannel channel;
  for (unsigned k = 0; k < in.mNumKeys; ++k) {
    const aiMeshMorphKey& key = in.mKeys[k];
    const double t = key.mTime / ticks;
    if (!std::isfinite(t)) throw std::runtime_error("a key time is not finite");
    if (!channel.times.empty() && t <= channel.times.back()) continue;
    channel.times.push_back(t);
    channel.weights.resize(channel.times.size() * count, std::numeric_limits<float>::quiet_NaN());
    float* const weights = &channel.weights[channel.weights.size() - count];
    const auto set = [&](std::size_t target, double weight) {
      if (!std::isfinite(weight))
        throw std::runtime_error("clip '" + clip + "': a weight of mesh '" + mesh.name + "' is not finite");
      weights[target] = static_cast<float>(weight);
    };
    // Of a cubic key assimp 5.2.5 gives all but the first and the last of: tangents, weights, tangents.
    const bool cubic = count > 1 && key.mNumValuesAndWeights == 3 * count - 2;
    for (unsigned n = 0; n < key.mNumValuesAndWeights && !cubic; ++n)
      if (key.mValues[n] < count) set(key.mValues[n], key.mWeights[n]);
    for (std::size_t m = 0; m < count && cubic; ++m) set(m, key.mWeights[count - 1 + m]);
  }
  fill_gaps(mesh, channel);
  return channel;
}

bool is_png_or_jpeg(const std::vector<std::uint8_t>& bytes) {
  const std::string start(bytes.begin(), bytes.begin() + std::min<std::ptrdiff_t>(4, std::ssize(bytes)));
  return start == "\x89PNG" || start.rfind("\xFF\xD8\xFF", 0) == 0;
}

}  // namespace

SceneBuilder::SceneBuilder(const aiScene& in, const std::string& format, OriginalNames original_names,
                           ReadTexture read_texture, const ReadLimits& limits)
    : in_(in),
      original_names_(std::move(original_names)),
      read_texture_(std::move(read_texture)),
      limits_(limits) {
  out_.format = format == "glb" ? "gltf" : (format == "dae" ? "collada" : format);
}

SourceScene SceneBuilder::build() {
  collect_nodes();
  name_nodes();
  collect_metadata();
  if (out_.format != "bvh") {  // whose meshes are assimp's stick figures
    collect_materials();
    for (std::size_t i = 0; i < source_.size(); ++i)
      for (unsigned m = 0; m < source_[i]->mNumMeshes; ++m)
        collect_mesh(*in_.mMeshes[source_[i]->mMeshes[m]], static_cast<int>(i));
  }
  for (unsigned a = 0; a < in_.mNumAnimations; ++a) collect_clip(*in_.mAnimations[a]);
  fold_fbx_pivots(out_);
  mark_bones();
  return std::move(out_);
}

void SceneBuilder::collect_nodes() {
  struct Open {
    const aiNode* node;
    int parent, depth;
  };
  std::vector<Open> stack{{in_.mRootNode, -1, 0}};
  while (!stack.empty()) {
    const Open open = stack.back();
    stack.pop_back();
    if (open.depth > limits_.max_depth) throw std::runtime_error("nodes are nested too deeply");
    if (static_cast<int>(out_.nodes.size()) >= limits_.max_nodes) throw std::runtime_error("too many nodes");
    const std::string known_as = open.node->mName.C_Str();
    const auto original = original_names_.find(known_as);
    SourceNode node;
    node.original_name = clean_text(original == original_names_.end() ? known_as : original->second);
    node.parent = open.parent;
    node.local = matrix_of(open.node->mTransformation);
    const int index = static_cast<int>(out_.nodes.size());
    out_.nodes.push_back(node);
    source_.push_back(open.node);
    by_name_[known_as].push_back(index);
    for (unsigned c = open.node->mNumChildren; c-- > 0;)
      stack.push_back({open.node->mChildren[c], index, open.depth + 1});
  }
}

/// Joints first, so that of a joint and its mesh with one name the joint keeps it: clips of other files go by
/// it.
void SceneBuilder::name_nodes() {
  std::set<std::string> used;
  std::unordered_map<std::string, int> next;  // number to try, per name: repeats stay linear
  int repeated = 0;
  for (const bool with_mesh : {false, true}) {
    for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
      if ((source_[i]->mNumMeshes > 0) != with_mesh) continue;
      SourceNode& node = out_.nodes[i];
      const std::string known_as = source_[i]->mName.C_Str();
      const std::string unnamed = known_as.empty() ? "node" : clean_text(known_as);
      const std::string plain = node.original_name.empty() ? unnamed : node.original_name;
      node.name = plain;
      int& number = next.try_emplace(plain, 2).first->second;
      while (!used.insert(node.name).second) node.name = plain + "_" + std::to_string(number++);
      if (node.name != plain && !node.original_name.empty()) ++repeated;
    }
  }
  if (repeated) out_.notes.push_back(std::to_string(repeated) + " nodes shared a name; renamed");
}

/// A name may stand for a joint and for the mesh that it carries: the joint is meant.
int SceneBuilder::node_named(const aiString& name) const {
  const auto found = by_name_.find(name.C_Str());
  if (found == by_name_.end()) return -1;
  int best = found->second.front();
  for (const int i : found->second)
    if (source_[i]->mNumMeshes == 0 &&
        (source_[best]->mNumMeshes > 0 || source_[i]->mNumChildren > source_[best]->mNumChildren))
      best = i;
  return best;
}

void SceneBuilder::collect_metadata() {
  if (out_.format == "gltf" || out_.format == "collada") {  // COLLADA: assimp turns and scales the root
    out_.meters_per_unit = 1;
    out_.up_axis = 1;
  } else if (out_.format == "fbx" && in_.mMetaData) {
    double unit = 0;  // in centimetres
    float unit_float = 0;
    if (in_.mMetaData->Get("UnitScaleFactor", unit))
      out_.meters_per_unit = unit / 100;
    else if (in_.mMetaData->Get("UnitScaleFactor", unit_float))
      out_.meters_per_unit = double(unit_float) / 100;
    if (!(out_.meters_per_unit > 0)) out_.meters_per_unit = 0;
    std::int32_t up = -1;
    if (in_.mMetaData->Get("UpAxis", up) && up >= 0 && up <= 2) out_.up_axis = up;
  }
}

std::vector<std::uint8_t> SceneBuilder::texture_bytes(const std::string& path) const {
  const aiTexture* t = in_.GetEmbeddedTexture(path.c_str());
  if (!t) return read_texture_(path);
  if (t->mHeight != 0) return {};  // raw pixels: no format here uses them
  const auto* data = reinterpret_cast<const std::uint8_t*>(t->pcData);
  return {data, data + t->mWidth};
}

void SceneBuilder::collect_materials() {
  for (unsigned i = 0; i < in_.mNumMaterials; ++i) {
    const aiMaterial& m = *in_.mMaterials[i];
    SourceMaterial material;
    aiString name;
    if (m.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = clean_text(name.C_Str());
    aiColor4D color;
    if (m.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
        m.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS)
      material.base_color = {color.r, color.g, color.b, color.a};
    aiString path;
    if (m.GetTexture(aiTextureType_BASE_COLOR, 0, &path) == aiReturn_SUCCESS ||
        m.GetTexture(aiTextureType_DIFFUSE, 0, &path) == aiReturn_SUCCESS) {
      material.texture = texture_bytes(path.C_Str());
      const std::string texture = std::string("texture '") + clean_text(path.C_Str()) + "' ";
      if (material.texture.empty()) {
        out_.notes.push_back(texture + "not found; left out");
      } else if (!is_png_or_jpeg(material.texture)) {
        out_.notes.push_back(texture + "is neither PNG nor JPEG; left out");
        material.texture.clear();
      }
    }
    out_.materials.push_back(std::move(material));
  }
}

void SceneBuilder::collect_mesh(const aiMesh& in, int node) {
  SourceMesh mesh;
  mesh.name = clean_text(in.mName.C_Str());
  mesh.material = static_cast<int>(in.mMaterialIndex);
  mesh.node = node;
  for (unsigned v = 0; v < in.mNumVertices; ++v) {
    mesh.positions.push_back({in.mVertices[v].x, in.mVertices[v].y, in.mVertices[v].z});
    if (in.mNormals) mesh.normals.push_back({in.mNormals[v].x, in.mNormals[v].y, in.mNormals[v].z});
    if (in.mTextureCoords[0]) mesh.uvs.push_back({in.mTextureCoords[0][v].x, 1 - in.mTextureCoords[0][v].y});
  }
  int damaged = 0;
  for (unsigned m = 0; m < in.mNumAnimMeshes; ++m) {
    const aiAnimMesh& target = *in.mAnimMeshes[m];
    const bool fits = target.mNumVertices == in.mNumVertices;
    damaged += !fits;
    mesh.morphs.push_back(fits ? morph_of(in, target, out_.format == "fbx")
                               : SourceMesh::Morph{});  // clips count all of them
    if (mesh.morphs.back().moves.empty()) mesh.morphs.back().moves.resize(in.mNumVertices);
  }
  if (damaged > 0)
    out_.notes.push_back("mesh '" + mesh.name + "': " + std::to_string(damaged) +
                         " morph targets of other vertices left out");
  for (unsigned f = 0; f < in.mNumFaces; ++f)
    if (in.mFaces[f].mNumIndices == 3)
      for (unsigned k = 0; k < 3; ++k) mesh.indices.push_back(in.mFaces[f].mIndices[k]);
  for (unsigned b = 0; b < in.mNumBones; ++b) {
    const aiBone& bone = *in.mBones[b];
    SourceMesh::Bone made;
    made.node = node_named(bone.mName);
    if (made.node < 0)
      throw std::runtime_error(std::string("skin names a bone '") + bone.mName.C_Str() + "' that is no node");
    made.inverse_bind = matrix_of(bone.mOffsetMatrix);
    for (unsigned w = 0; w < bone.mNumWeights; ++w)
      made.weights.emplace_back(bone.mWeights[w].mVertexId, bone.mWeights[w].mWeight);
    out_.nodes[made.node].is_bone = true;
    mesh.bones.push_back(std::move(made));
  }
  if (mesh.indices.empty())
    out_.notes.push_back("mesh '" + mesh.name + "' is of points or lines; left out");
  else
    out_.meshes.push_back(std::move(mesh));
}

SourceChannel SceneBuilder::channel_of(const aiNodeAnim& in, int node, double ticks,
                                       const std::string& clip) {
  const std::string where = "clip '" + clip + "', node '" + out_.nodes[node].name + "': ";
  SourceChannel channel;
  channel.node = node;
  int dropped = 0;
  try {
    dropped +=
        copy_keys(in.mPositionKeys, in.mNumPositionKeys, ticks, channel.position_times, channel.positions);
    dropped +=
        copy_keys(in.mRotationKeys, in.mNumRotationKeys, ticks, channel.rotation_times, channel.rotations);
    dropped += copy_keys(in.mScalingKeys, in.mNumScalingKeys, ticks, channel.scale_times, channel.scales);
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(where + e.what());
  }
  if (dropped > 0) out_.notes.push_back(where + std::to_string(dropped) + " keys out of order; left out");
  return channel;
}

/// Of every mesh that the channel's node carries, or that is named so: assimp adds a star and a number to
/// names of FBX files.
void SceneBuilder::collect_morphs(const aiMeshMorphAnim& in, double ticks, SourceClip& clip) {
  const std::string name = clean_text(in.mName.C_Str()), plain = name.substr(0, name.rfind('*'));
  const int node = node_named(in.mName);
  const auto moves = [&](const SourceMesh& mesh) {
    if (node >= 0) return mesh.node == node;
    return mesh.name == plain || out_.nodes[std::size_t(mesh.node)].original_name == plain;
  };
  bool any = false;
  for (std::size_t m = 0; m < out_.meshes.size(); ++m) {
    const SourceMesh& mesh = out_.meshes[m];
    if (mesh.morphs.empty() || !moves(mesh)) continue;
    any = true;
    SourceMorphChannel channel = morph_channel_of(in, mesh, ticks, clip.name);
    channel.mesh = static_cast<int>(m);
    if (!channel.times.empty()) clip.morphs.push_back(std::move(channel));
  }
  if (!any)
    out_.notes.push_back("clip '" + clip.name + "' moves morph targets of '" + name + "', which has none");
}

void SceneBuilder::collect_clip(const aiAnimation& in) {
  SourceClip clip;
  clip.name = in.mName.length ? clean_text(in.mName.C_Str()) : "clip_" + std::to_string(out_.clips.size());
  const bool known = in.mTicksPerSecond > 0 && std::isfinite(in.mTicksPerSecond);
  const double ticks = known ? in.mTicksPerSecond : kTicksWhenUnknown;
  if (!known) out_.notes.push_back("clip '" + clip.name + "' has no ticks per second; 25 taken");
  for (unsigned c = 0; c < in.mNumChannels; ++c) {
    const int node = node_named(in.mChannels[c]->mNodeName);
    if (node >= 0)
      clip.channels.push_back(channel_of(*in.mChannels[c], node, ticks, clip.name));
    else
      out_.notes.push_back("clip '" + clip.name + "' moves '" +
                           clean_text(in.mChannels[c]->mNodeName.C_Str()) +
                           "', which does not exist; left out");
  }
  for (unsigned c = 0; c < in.mNumMorphMeshChannels; ++c)
    collect_morphs(*in.mMorphMeshChannels[c], ticks, clip);
  double first = std::numeric_limits<double>::max(), last = 0;
  for_each_track(clip, [&](const std::vector<double>& times) {
    last = std::max(last, times.back());
    if (times.size() > 1)
      first = std::min(first, times.front());  // one key: assimp's, at 0, for a still track
  });
  first = std::min(first, last);
  for_each_track(clip, [&](std::vector<double>& times) {  // a first key that comes late is a gap, not a pose
    for (double& t : times) t = std::max(0.0, t - first);
  });
  if (first > 1e-6)
    out_.notes.push_back("clip '" + clip.name + "' begins at " + std::to_string(first) + " s; moved to 0");
  clip.begin = first;
  clip.duration = last - first;
  clip.key_rate = key_rate(clip);
  out_.clips.push_back(std::move(clip));
}

/// Without a skin, what moves is a joint, or what carries a mesh that clips only morph; in BVH every node but
/// the end sites is one.
void SceneBuilder::mark_bones() {
  if (out_.format == "bvh") {
    for (SourceNode& n : out_.nodes) n.is_bone = n.original_name.rfind("EndSite", 0) != 0;
    return;
  }
  if (std::any_of(out_.nodes.begin(), out_.nodes.end(), [](const SourceNode& n) { return n.is_bone; }))
    return;
  bool any = false;
  for (const SourceClip& clip : out_.clips)
    for (const SourceChannel& c : clip.channels) any = out_.nodes[c.node].is_bone = true;
  if (any) return;
  for (const SourceClip& clip : out_.clips)
    for (const SourceMorphChannel& c : clip.morphs) out_.nodes[out_.meshes[c.mesh].node].is_bone = true;
}

}  // namespace sinew::import
