// A skeleton and one motion → BVH.
#pragma once

#include "convert/convert.h"
#include "export/motion.h"

namespace sinew::exporting {

/// The file's text: metres, Y up, a figure looks along +Z. Every joint is one of the file, its frame at rest
/// along the axes of the world, as the format has it. Where a joint changes its distance to its parent it has
/// position channels, which hold its whole place in the parent's frame (as Blender, assimp and MotionBuilder
/// read them; some readers add them to the offset). `motion.times` are evenly spaced.
///
/// Fails for a skeleton with several roots. `notes` gains what was renamed.
convert::Error write_bvh(const Skeleton& skeleton, const Motion& motion, std::string& out,
                         std::vector<std::string>& notes);

}  // namespace sinew::exporting
