#include <assimp/GltfMaterial.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include "import/readers.h"

namespace sinew::import {
namespace {

constexpr const char* kPivot = "_$AssimpFbx$_";

/// A file in memory, as assimp wants it.
class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string content) : content_(std::move(content)) {}
  size_t Read(void* to, size_t size, size_t count) override {
    if (size == 0) return 0;
    const size_t items = std::min(count, (content_.size() - at_) / size);
    std::memcpy(to, content_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t base = origin == aiOrigin_SET ? 0 : (origin == aiOrigin_CUR ? at_ : content_.size());
    const size_t to = origin == aiOrigin_END ? base - offset : base + offset;
    if (to > content_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return content_.size(); }
  void Flush() override {}

 private:
  std::string content_;
  size_t at_ = 0;
};

/// The main file and what was opened beside it; nothing else exists.
class ClosedWorld : public Assimp::IOSystem {
 public:
  ClosedWorld(std::string main_name, const std::string& main, const SideFiles& side, std::uint64_t most)
      : main_name_(std::move(main_name)), main_(main), side_(side), most_(most) {}
  bool Exists(const char* file) const override { return file == main_name_ || find(file) != side_.end(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (file == main_name_) return new MemoryStream(main_);
    const auto found = find(file);
    return found == side_.end() ? nullptr : new MemoryStream(read_descriptor(found->second, most_));
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  SideFiles::const_iterator find(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    while (name.rfind("./", 0) == 0) name.erase(0, 2);
    if (const auto exact = side_.find(name); exact != side_.end()) return exact;
    const auto slash = name.rfind('/');
    return slash == std::string::npos ? side_.end() : side_.find(name.substr(slash + 1));
  }

 private:
  std::string main_name_;
  const std::string& main_;
  const SideFiles& side_;
  std::uint64_t most_;
};

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned r = 0; r < 4; ++r)
    for (unsigned c = 0; c < 4; ++c) out(r, c) = double(m[r][c]);
  return out;
}

Eigen::Quaterniond quaternion_of(const aiQuaternion& q) {
  return {double(q.w), double(q.x), double(q.y), double(q.z)};
}
Eigen::Vector3d vector_of(const aiVector3D& v) {
  return {double(v.x), double(v.y), double(v.z)};
}

/// Value of a keyed curve at t: linear (positions, scales) or the shorter way round (rotations).
template <class V>
V interpolate(const std::vector<double>& times, const std::vector<V>& keys, double t, const V& otherwise) {
  if (keys.empty()) return otherwise;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return keys.front();
  if (after == times.end()) return keys.back();
  const std::size_t i = static_cast<std::size_t>(after - times.begin());
  const double span = times[i] - times[i - 1], u = span > 0 ? (t - times[i - 1]) / span : 0;
  if constexpr (std::is_same_v<V, Eigen::Quaterniond>) {
    return keys[i - 1].slerp(u, keys[i]);
  } else {
    return keys[i - 1] + u * (keys[i] - keys[i - 1]);
  }
}

void decompose(const Eigen::Matrix4d& m, Eigen::Vector3d& t, Eigen::Quaterniond& r, Eigen::Vector3d& s) {
  t = m.block<3, 1>(0, 3);
  Eigen::Matrix3d a = m.block<3, 3>(0, 0);
  s = a.colwise().norm();
  if (a.determinant() < 0) s[0] = -s[0];
  for (int k = 0; k < 3; ++k) a.col(k) /= std::abs(s[k]) > 1e-12 ? s[k] : 1;
  r = Eigen::Quaterniond(a).normalized();
}

Eigen::Matrix4d compose(const Eigen::Vector3d& t, const Eigen::Quaterniond& r, const Eigen::Vector3d& s) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = r.toRotationMatrix() * s.asDiagonal();
  m.block<3, 1>(0, 3) = t;
  return m;
}

class SceneBuilder {
 public:
  SceneBuilder(const aiScene& in, const std::string& format, const ClosedWorld& files,
               const ReadLimits& limits)
      : in_(in), format_(format), files_(files), limits_(limits) {}

  SourceScene build() {
    out_.format = format_ == "glb" ? "gltf" : (format_ == "dae" ? "collada" : format_);
    collect_nodes();
    collect_metadata();
    collect_materials();
    if (out_.format == "bvh") {
      out_.materials.clear();
    } else {
      for (unsigned m = 0; m < in_.mNumMeshes; ++m) collect_mesh(*in_.mMeshes[m], m);
    }
    for (unsigned a = 0; a < in_.mNumAnimations; ++a) collect_clip(*in_.mAnimations[a]);
    fold_pivots();
    mark_bones();
    return std::move(out_);
  }

 private:
  void collect_nodes() {
    struct Open {
      const aiNode* node;
      int parent, depth;
    };
    std::vector<Open> stack{{in_.mRootNode, -1, 0}};
    std::set<std::string> used;
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      if (open.depth > limits_.max_depth) throw std::runtime_error("nodes are nested too deeply");
      if (static_cast<int>(out_.nodes.size()) > limits_.max_nodes) throw std::runtime_error("too many nodes");
      SourceNode node;
      node.original_name = open.node->mName.C_Str();
      node.name = node.original_name.empty() ? "node" : node.original_name;
      if (used.count(node.name)) {
        int k = 2;
        while (used.count(node.name + "_" + std::to_string(k))) ++k;
        node.name += "_" + std::to_string(k);
        if (!node.original_name.empty()) ++repeated_;
      }
      used.insert(node.name);
      node.parent = open.parent;
      node.local = matrix_of(open.node->mTransformation);
      const int index = static_cast<int>(out_.nodes.size());
      out_.nodes.push_back(node);
      source_.push_back(open.node);
      by_name_[node.original_name].push_back(index);
      for (unsigned m = 0; m < open.node->mNumMeshes; ++m) mesh_node_[open.node->mMeshes[m]] = index;
      for (unsigned c = open.node->mNumChildren; c-- > 0;)
        stack.push_back({open.node->mChildren[c], index, open.depth + 1});
    }
    if (repeated_) out_.notes.push_back(std::to_string(repeated_) + " nodes shared a name; renamed");
  }

  /// A name may stand for a joint and for the mesh that it carries: the joint is meant.
  int node_named(const aiString& name) const {
    const auto found = by_name_.find(name.C_Str());
    if (found == by_name_.end()) return -1;
    int best = found->second.front();
    for (const int i : found->second)
      if (source_[i]->mNumMeshes == 0 &&
          (source_[best]->mNumMeshes > 0 || source_[i]->mNumChildren > source_[best]->mNumChildren))
        best = i;
    return best;
  }

  void collect_metadata() {
    if (out_.format == "gltf") {
      out_.meters_per_unit = 1;
      out_.up_axis = 1;
    } else if (out_.format == "collada") {
      out_.meters_per_unit = 1;  // assimp puts unit and up axis into the root node
      out_.up_axis = 1;
    } else if (out_.format == "fbx" && in_.mMetaData) {
      double unit = 0;
      float unit_float = 0;
      if (in_.mMetaData->Get("UnitScaleFactor", unit))
        out_.meters_per_unit = unit / 100;
      else if (in_.mMetaData->Get("UnitScaleFactor", unit_float))
        out_.meters_per_unit = double(unit_float) / 100;
      std::int32_t up = -1;
      if (in_.mMetaData->Get("UpAxis", up) && up >= 0 && up <= 2) out_.up_axis = up;
    }
  }

  std::vector<std::uint8_t> texture_bytes(const std::string& path) const {
    if (const aiTexture* t = in_.GetEmbeddedTexture(path.c_str())) {
      if (t->mHeight != 0) return {};  // raw pixels: no format here uses them
      const auto* data = reinterpret_cast<const std::uint8_t*>(t->pcData);
      return {data, data + t->mWidth};
    }
    Assimp::IOStream* stream = const_cast<ClosedWorld&>(files_).Open(path.c_str(), "rb");
    if (!stream) return {};
    std::vector<std::uint8_t> bytes(stream->FileSize());
    stream->Read(bytes.data(), 1, bytes.size());
    const_cast<ClosedWorld&>(files_).Close(stream);
    return bytes;
  }

  void collect_materials() {
    for (unsigned i = 0; i < in_.mNumMaterials; ++i) {
      const aiMaterial& m = *in_.mMaterials[i];
      SourceMaterial material;
      aiString name;
      if (m.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
      aiColor4D color;
      if (m.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
          m.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS)
        material.base_color = {color.r, color.g, color.b, color.a};
      aiString path;
      if (m.GetTexture(aiTextureType_BASE_COLOR, 0, &path) == aiReturn_SUCCESS ||
          m.GetTexture(aiTextureType_DIFFUSE, 0, &path) == aiReturn_SUCCESS) {
        material.texture = texture_bytes(path.C_Str());
        if (material.texture.empty())
          out_.notes.push_back(std::string("texture '") + path.C_Str() + "' not found; left out");
      }
      out_.materials.push_back(std::move(material));
    }
  }

  void collect_mesh(const aiMesh& in, unsigned index) {
    SourceMesh mesh;
    mesh.name = in.mName.C_Str();
    mesh.material = static_cast<int>(in.mMaterialIndex);
    const auto node = mesh_node_.find(index);
    mesh.node = node == mesh_node_.end() ? -1 : node->second;
    for (unsigned v = 0; v < in.mNumVertices; ++v) {
      mesh.positions.push_back({in.mVertices[v].x, in.mVertices[v].y, in.mVertices[v].z});
      if (in.mNormals) mesh.normals.push_back({in.mNormals[v].x, in.mNormals[v].y, in.mNormals[v].z});
      if (in.mTextureCoords[0])
        mesh.uvs.push_back({in.mTextureCoords[0][v].x, 1 - in.mTextureCoords[0][v].y});
    }
    for (unsigned f = 0; f < in.mNumFaces; ++f)
      if (in.mFaces[f].mNumIndices == 3)
        for (unsigned k = 0; k < 3; ++k) mesh.indices.push_back(in.mFaces[f].mIndices[k]);
    for (unsigned b = 0; b < in.mNumBones; ++b) {
      const aiBone& bone = *in.mBones[b];
      SourceMesh::Bone made;
      made.node = node_named(bone.mName);
      if (made.node < 0)
        throw std::runtime_error(std::string("skin names a bone '") + bone.mName.C_Str() +
                                 "' that is no node");
      made.inverse_bind = matrix_of(bone.mOffsetMatrix);
      for (unsigned w = 0; w < bone.mNumWeights; ++w)
        made.weights.emplace_back(bone.mWeights[w].mVertexId, bone.mWeights[w].mWeight);
      out_.nodes[made.node].is_bone = true;
      mesh.bones.push_back(std::move(made));
    }
    if (!mesh.indices.empty()) out_.meshes.push_back(std::move(mesh));
  }

  void collect_clip(const aiAnimation& in) {
    SourceClip clip;
    clip.name = in.mName.length ? in.mName.C_Str() : "clip_" + std::to_string(out_.clips.size());
    const double ticks = in.mTicksPerSecond > 0 ? in.mTicksPerSecond : 25;
    double first = 1e300, last = 0;
    std::vector<double> intervals;
    for (unsigned c = 0; c < in.mNumChannels; ++c) {
      const aiNodeAnim& source = *in.mChannels[c];
      SourceChannel channel;
      channel.node = node_named(source.mNodeName);
      if (channel.node < 0) {
        out_.notes.push_back("clip '" + clip.name + "' moves '" + source.mNodeName.C_Str() +
                             "', which does not exist; left out");
        continue;
      }
      const auto keys = [&](auto* from, unsigned count, std::vector<double>& times, auto& values,
                            auto convert) {
        for (unsigned k = 0; k < count; ++k) {
          const double t = from[k].mTime / ticks;
          if (!times.empty() && t <= times.back()) continue;  // times must rise; the first of equals stays
          times.push_back(t);
          values.push_back(convert(from[k].mValue));
          first = std::min(first, t);
          last = std::max(last, t);
          if (times.size() > 1) intervals.push_back(times.back() - times[times.size() - 2]);
        }
      };
      keys(source.mPositionKeys, source.mNumPositionKeys, channel.position_times, channel.positions,
           vector_of);
      keys(source.mRotationKeys, source.mNumRotationKeys, channel.rotation_times, channel.rotations,
           quaternion_of);
      keys(source.mScalingKeys, source.mNumScalingKeys, channel.scale_times, channel.scales, vector_of);
      clip.channels.push_back(std::move(channel));
    }
    if (first > last) first = last;
    for (SourceChannel& c : clip.channels)  // a first key that comes late is a gap, not a pose
      for (auto* times : {&c.position_times, &c.rotation_times, &c.scale_times})
        for (double& t : *times) t -= first;
    if (first > 1e-6)
      out_.notes.push_back("clip '" + clip.name + "' begins at " + std::to_string(first) + " s; moved to 0");
    clip.duration = last - first;
    if (!intervals.empty()) {
      std::nth_element(intervals.begin(),
                       intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2),
                       intervals.end());
      const double median = intervals[intervals.size() / 2];
      if (median > 0) clip.key_rate = 1 / median;
    }
    out_.clips.push_back(std::move(clip));
  }

  static bool is_pivot(const SourceNode& n) { return n.original_name.find(kPivot) != std::string::npos; }

  /// FBX pivots come as helper nodes above their joint. They are multiplied into it, animated ones key by
  /// key.
  void fold_pivots() {
    const int count = static_cast<int>(out_.nodes.size());
    std::vector<std::vector<int>> chain(count);  // of a real node: its pivots from the top, then itself
    int folded = 0;
    for (int i = 0; i < count; ++i) {
      if (is_pivot(out_.nodes[i])) continue;
      std::vector<int>& c = chain[i];
      c.push_back(i);
      for (int p = out_.nodes[i].parent; p >= 0 && is_pivot(out_.nodes[p]); p = out_.nodes[p].parent)
        c.insert(c.begin(), p);
      folded += static_cast<int>(c.size()) - 1;
    }
    if (folded == 0) return;
    for (SourceClip& clip : out_.clips) {
      std::vector<const SourceChannel*> of_node(count, nullptr);
      for (const SourceChannel& c : clip.channels) of_node[c.node] = &c;
      std::vector<SourceChannel> merged;
      for (int i = 0; i < count; ++i) {
        std::set<double> times;
        for (const int n : chain[i])
          if (const SourceChannel* c = of_node[n])
            for (const auto* t : {&c->position_times, &c->rotation_times, &c->scale_times})
              times.insert(t->begin(), t->end());
        if (times.empty()) continue;
        SourceChannel channel;
        channel.node = i;
        for (const double t : times) {
          Eigen::Matrix4d local = Eigen::Matrix4d::Identity();
          for (const int n : chain[i]) local *= local_at(n, of_node[n], t);
          Eigen::Vector3d position, scale;
          Eigen::Quaterniond rotation;
          decompose(local, position, rotation, scale);
          channel.position_times.push_back(t);
          channel.positions.push_back(position);
          channel.rotations.push_back(rotation);
          channel.scales.push_back(scale);
        }
        channel.rotation_times = channel.scale_times = channel.position_times;
        merged.push_back(std::move(channel));
      }
      clip.channels = std::move(merged);
    }
    std::vector<int> renumbered(count, -1);
    std::vector<SourceNode> kept;
    for (int i = 0; i < count; ++i) {
      if (is_pivot(out_.nodes[i])) continue;
      SourceNode node = out_.nodes[i];
      node.local = Eigen::Matrix4d::Identity();
      for (const int n : chain[i]) node.local *= out_.nodes[n].local;
      int parent = out_.nodes[chain[i].front()].parent;
      while (parent >= 0 && is_pivot(out_.nodes[parent])) parent = out_.nodes[parent].parent;
      node.parent = parent < 0 ? -1 : renumbered[parent];
      renumbered[i] = static_cast<int>(kept.size());
      kept.push_back(std::move(node));
    }
    out_.nodes = std::move(kept);
    const auto moved = [&](int n) { return n < 0 ? n : renumbered[n]; };
    for (SourceMesh& m : out_.meshes) {
      m.node = moved(m.node);
      for (SourceMesh::Bone& b : m.bones) b.node = moved(b.node);
    }
    for (SourceClip& clip : out_.clips)
      for (SourceChannel& c : clip.channels) c.node = moved(c.node);
    out_.notes.push_back(std::to_string(folded) + " FBX pivot nodes folded into their joints");
  }

  Eigen::Matrix4d local_at(int node, const SourceChannel* c, double t) const {
    if (!c) return out_.nodes[node].local;
    Eigen::Vector3d position, scale;
    Eigen::Quaterniond rotation;
    decompose(out_.nodes[node].local, position, rotation, scale);
    return compose(interpolate(c->position_times, c->positions, t, position),
                   interpolate(c->rotation_times, c->rotations, t, rotation),
                   interpolate(c->scale_times, c->scales, t, scale));
  }

  /// Without a skin, what moves is a joint; in BVH every node but the end sites is one.
  void mark_bones() {
    if (out_.format == "bvh") {
      for (SourceNode& n : out_.nodes)
        n.is_bone = n.original_name.find("EndSite") == std::string::npos && n.parent >= -1;
      return;
    }
    const bool skinned =
        std::any_of(out_.nodes.begin(), out_.nodes.end(), [](const SourceNode& n) { return n.is_bone; });
    if (skinned) return;
    for (const SourceClip& clip : out_.clips)
      for (const SourceChannel& c : clip.channels) out_.nodes[c.node].is_bone = true;
  }

  const aiScene& in_;
  std::string format_;
  const ClosedWorld& files_;
  const ReadLimits& limits_;
  SourceScene out_;
  std::vector<const aiNode*> source_;
  std::unordered_map<std::string, std::vector<int>> by_name_;
  std::unordered_map<unsigned, int> mesh_node_;
  int repeated_ = 0;
};

/// Only the importers of our formats: assimp's sniffing is an attack surface (ecosystem, section 3.2).
void keep_only(Assimp::Importer& importer, const std::string& extension) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const aiImporterDesc* info = importer.GetImporterInfo(i);
    const std::string name = info ? info->mName : "";
    const bool wanted = (extension == "gltf" || extension == "glb") ? name.rfind("glTF2", 0) == 0
                        : extension == "fbx"                        ? name.find("FBX") != std::string::npos
                        : extension == "bvh"                        ? name.rfind("BVH", 0) == 0
                                                                    : name.rfind("Collada", 0) == 0;
    if (!wanted) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) importer.UnregisterLoader(other);
}

}  // namespace

SourceScene read_with_assimp(const std::string& content, const std::string& format,
                             const SideFiles& side_files, const ReadLimits& limits) {
  const std::string name = "source." + format;
  Assimp::Importer importer;
  keep_only(importer, format);
  auto files = std::make_unique<ClosedWorld>(name, content, side_files, limits.max_file_bytes);
  const ClosedWorld& world = *files;
  importer.SetIOHandler(files.release());
  // Stick figures only for BVH, whose scenes would not pass validation without a mesh; they are dropped
  // again.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, format != "bvh");
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  unsigned steps = aiProcess_ValidateDataStructure;
  const aiScene* scene = importer.ReadFile(name, steps);
  if (scene && scene->mNumMeshes > 0)
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals);
  if (!scene) throw std::runtime_error(importer.GetErrorString());
  if (!scene->mRootNode) throw std::runtime_error("it has no nodes");
  return SceneBuilder(*scene, format, world, limits).build();
}

}  // namespace sinew::import
