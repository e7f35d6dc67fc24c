#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <memory>
#include <new>
#include <stdexcept>

#include "import/assimp_files.h"
#include "import/gltf_document.h"
#include "import/readers.h"
#include "import/scene_builder.h"

namespace sinew::import {
namespace {

/// Only the importer of the format: assimp's sniffing is an attack surface (ecosystem, section 3.2).
void keep_only(Assimp::Importer& importer, const std::string& extension) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const aiImporterDesc* info = importer.GetImporterInfo(i);
    const std::string name = info ? info->mName : "";
    const bool wanted = (extension == "gltf" || extension == "glb") ? name.rfind("glTF2", 0) == 0
                        : extension == "fbx"                        ? name.find("FBX") != std::string::npos
                        : extension == "bvh"                        ? name.rfind("BVH", 0) == 0
                        : extension == "stl"                        ? name.rfind("Stereolithography", 0) == 0
                        : extension == "obj"                        ? name.rfind("Wavefront", 0) == 0
                                                                    : name.rfind("Collada", 0) == 0;
    if (!wanted) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) importer.UnregisterLoader(other);
}

/// Empty where it cannot be read.
std::vector<std::uint8_t> read_beside(ClosedWorld& files, const std::string& name) {
  const std::unique_ptr<Assimp::IOStream> stream(files.Open(name.c_str(), "rb"));
  if (!stream) return {};
  std::vector<std::uint8_t> bytes(stream->FileSize());
  stream->Read(bytes.data(), 1, bytes.size());
  return bytes;
}

[[noreturn]] void fail(const std::string& message) {
  if (message.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  throw std::runtime_error("assimp: " + message);
}

SourceScene read(const std::string& content, const std::string& format, const OpenFile& open_file,
                 const ReadLimits& limits, bool part) {
  GltfDocument gltf;
  SceneBuilder::OriginalNames original_names;
  const bool is_gltf = format == "gltf" || format == "glb";
  const std::string name = "source." + format;
  if (is_gltf) {
    ClosedWorld beside(name, content, open_file, limits.max_file_bytes);
    gltf = prepare_gltf(content, format == "glb", limits, [&](const std::string& file) {
      const std::vector<std::uint8_t> bytes = read_beside(beside, file);
      return std::string(bytes.begin(), bytes.end());
    });
    for (std::size_t k = 0; k < gltf.node_names.size(); ++k) original_names[node_tag(k)] = gltf.node_names[k];
  }
  Assimp::Importer importer;
  keep_only(importer, format);
  auto* files = new ClosedWorld(name, is_gltf ? gltf.content : content, open_file, limits.max_file_bytes);
  if (!gltf.floats.empty()) files->add(kFloatsFile, std::move(gltf.floats));
  importer.SetIOHandler(files);  // owned by the importer from here on
  // Stick figures only for BVH, whose scenes would not pass validation without a mesh; SceneBuilder drops
  // them.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, format != "bvh");
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, part);
  // Validation on its own first: later steps crash on what it refuses. No step that joins vertices or limits
  // weights: those drop bones without weights.
  const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure);
  const unsigned joined = part ? aiProcess_JoinIdenticalVertices : 0u;
  if (scene && scene->mNumMeshes > 0)
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals | joined);
  if (!scene) fail(importer.GetErrorString());
  if (!scene->mRootNode) throw std::runtime_error("it has no nodes");
  const auto texture = [files](const std::string& path) { return read_beside(*files, path); };
  SourceScene out = SceneBuilder(*scene, format, std::move(original_names), texture, limits).build();
  out.notes.insert(out.notes.end(), gltf.notes.begin(), gltf.notes.end());
  out.extras = std::move(gltf.extras);
  if (out.clips.size() == gltf.animation_extras.size())  // else some moved nothing
    for (std::size_t a = 0; a < out.clips.size(); ++a) out.clips[a].extras = gltf.animation_extras[a];
  return out;
}

}  // namespace

SourceScene read_with_assimp(const std::string& content, const std::string& format, const OpenFile& open_file,
                             const ReadLimits& limits) {
  return read(content, format, open_file, limits, false);
}

SourceScene read_part(const std::string& content, const std::string& format, const OpenFile& open_file,
                      const ReadLimits& limits) {
  return read(content, format, open_file, limits, true);
}

}  // namespace sinew::import
