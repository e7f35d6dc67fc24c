// The physical body → URDF.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::exporting {

/// The file's text: links with masses, inertias and colliders (also to be seen), joints with axes, limits,
/// effort, damping and friction. What URDF has no joint for becomes several in a row with links without mass
/// between them: ball joints turn about their x, y and z axes, universal ones about their two. Capsules
/// become cylinders that are as long, as the project's own reader has it. A root that is bolted hangs on a
/// link called world; one that moves is the root link.
///
/// Fails for a skeleton with several roots. `notes` gains what URDF cannot hold: where a free root is at
/// rest, torque limits that differ by direction (the larger is the effort), limits of ball joints (the
/// largest angle bounds each axis).
convert::Error write_urdf(const Skeleton& skeleton, std::string& out, std::vector<std::string>& notes);

}  // namespace sinew::exporting
