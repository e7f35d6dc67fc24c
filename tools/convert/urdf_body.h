// URDF links → skeleton: as they are, repaired only where they could not exist.
#pragma once

#include "convert/options.h"
#include "import/source_scene.h"

namespace sinew::convert {

/// Joint names are link names, `Joint::source_joint` the URDF joint. Inertials are kept to the last bit.
Error build_urdf(const import::SourceScene& scene, const Options& options, Skeleton& out,
                 nlohmann::json& report);

}  // namespace sinew::convert
