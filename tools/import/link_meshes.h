// The meshes that a URDF's links refer to: found on disk, read each in a sandbox of its own, hung on their
// links.
#pragma once

#include <map>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

using Packages = std::map<std::string, std::string>;  ///< [name of a ROS package] its directory

/// Adds what a URDF's links look like to the scene that read_source made of it: one node per link, then those
/// of the visual meshes (STL, OBJ, COLLADA, glTF; m, in the link's frame at rest), with their materials.
/// `package://NAME/…` (or `model://`) is looked for in `packages`; else, upwards from the URDF, in a
/// directory of that name; else beside the URDF. Other names stand for files below the URDF's directory or
/// the one above it. Nothing else is opened. What is missing or broken is left out and noted. `scene.files`
/// takes what was looked for. Cost: a process per file.
void read_link_meshes(const std::string& urdf, const Packages& packages, const ReadLimits& limits,
                      SourceScene& scene);

}  // namespace sinew::import
