// The format readers that run inside the sandbox. They throw std::runtime_error with one clause.
#pragma once

#include <map>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// Files beside the source that it may refer to (.bin, textures): relative name → open descriptor.
using SideFiles = std::map<std::string, int>;

/// "gltf", "glb", "fbx", "bvh", "dae" or "urdf" by content; empty when it is none of them.
std::string detect_format(const std::string& content);

/// Cheap first look: nesting, sizes. Throws when the content would only waste the reader's time.
void check_shape(const std::string& content, const std::string& format, const ReadLimits& limits);

SourceScene read_with_assimp(const std::string& content, const std::string& format,
                             const SideFiles& side_files, const ReadLimits& limits);
SourceScene read_urdf(const std::string& content, const ReadLimits& limits);

/// Whole content of an open file, from its beginning.
std::string read_descriptor(int descriptor, std::uint64_t most);

}  // namespace sinew::import
