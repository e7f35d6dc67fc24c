// What a URDF's robot looks like: its links' meshes, and solids for links that have none.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "import/source_scene.h"
#include "sinew/io/asset.h"

namespace sinew::convert {

/// Fills meshes, materials and bind transforms of an asset whose joints are the scene's links, one to one.
/// Where some links have meshes, the others' primitive shapes become triangles too; where none has, nothing
/// is added: the shapes of the physical body are shown then.
void add_urdf_skin(const import::SourceScene& scene, nlohmann::json& report, Asset& asset);

/// [link] vertices of its visual meshes, in its frame, m.
std::vector<std::vector<Vec3<double>>> link_vertices(const import::SourceScene& scene);

}  // namespace sinew::convert
