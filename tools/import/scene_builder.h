// aiScene → SourceScene.
#pragma once

#include <assimp/scene.h>

#include <functional>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "import/source_scene.h"

namespace sinew::import {

class SceneBuilder {
 public:
  /// Encoded bytes of a texture beside the source; empty when there is none.
  using ReadTexture = std::function<std::vector<std::uint8_t>(const std::string& name)>;
  /// Name in the file of a node that assimp knows by another (see prepare_gltf).
  using OriginalNames = std::unordered_map<std::string, std::string>;

  SceneBuilder(const aiScene& in, const std::string& format, OriginalNames original_names,
               ReadTexture read_texture, const ReadLimits& limits);

  /// Throws std::runtime_error with one clause where the scene makes no sense.
  SourceScene build();

 private:
  void collect_nodes();
  void name_nodes();
  void collect_metadata();
  void collect_materials();
  void collect_mesh(const aiMesh& in, int node);
  void collect_clip(const aiAnimation& in);
  SourceChannel channel_of(const aiNodeAnim& in, int node, double ticks, const std::string& clip);
  void collect_morphs(const aiMeshMorphAnim& in, double ticks, SourceClip& clip);
  void mark_bones();
  int node_named(const aiString& name) const;
  std::vector<std::uint8_t> texture_bytes(const std::string& path) const;

  const aiScene& in_;
  OriginalNames original_names_;
  ReadTexture read_texture_;
  const ReadLimits& limits_;
  SourceScene out_;
  std::vector<const aiNode*> source_;  ///< of each node
  std::unordered_map<std::string, std::vector<int>> by_name_;
};

}  // namespace sinew::import
