// Meshes of a source as they stand on the character at rest, with four influences a vertex.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "import/source_scene.h"
#include "sinew/io/asset.h"

namespace sinew::convert {

/// A mesh, and which curves move its morph targets.
struct BakedMesh {
  Mesh mesh;
  std::vector<std::string> morph_names;  ///< [morph]
};

/// Which curve a morph target follows: what its author called it, so that
/// those of one name move together; else mesh and number.
std::string morph_curve(const import::SourceMesh& mesh, std::size_t morph);

/// The mesh in model space at rest, baked through its bind matrices. `world`: [node] transforms at rest,
/// `to_model` what brings them to metres and Z up. Vertices without weights follow the nearest joint above
/// the mesh's node; false, and a note, where there is none. Notes weights that had to be repaired.
/// Morph targets that move nothing by 10 µm are left out.
bool bake_mesh(const import::SourceMesh& in, const import::SourceScene& scene,
               const std::vector<Eigen::Matrix4d>& world, const Eigen::Matrix4d& to_model,
               const std::map<int, int>& joint_of_node, nlohmann::json& report, BakedMesh& out);

std::vector<Material> materials_of(const import::SourceScene& scene);

}  // namespace sinew::convert
