// URDF links → skeleton: as they are, repaired only where they could not exist.
#pragma once

#include "convert/options.h"
#include "import/source_scene.h"
#include "sinew/io/asset.h"

namespace sinew::convert {

/// Joint names are link names, `Joint::source_joint` the URDF joint. Inertials are kept to the last bit.
/// Links that collide by meshes get a box or capsule around what they look like.
Error build_urdf(const import::SourceScene& scene, const Options& options, Asset& out,
                 nlohmann::json& report);

}  // namespace sinew::convert
