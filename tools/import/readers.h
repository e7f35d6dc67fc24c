// The format readers that run inside the sandbox. They throw std::runtime_error with one clause.
#pragma once

#include <string>
#include <string_view>

#include "import/sandbox.h"
#include "import/source_scene.h"

namespace sinew::import {

/// "gltf", "glb", "fbx", "bvh", "dae" or "urdf" by content; empty when it is none of them.
std::string detect_format(const std::string& content);

/// Cheap first look: nesting, sizes. Throws when the content would only waste the reader's time.
void check_shape(const std::string& content, const std::string& format, const ReadLimits& limits);

/// Throws when brackets are nested deeper than any honest document has them.
void check_json_nesting(std::string_view text);

/// `open_file` gives descriptors of what the source refers to (.bin, textures).
SourceScene read_with_assimp(const std::string& content, const std::string& format, const OpenFile& open_file,
                             const ReadLimits& limits);
/// A part of a robot: also "stl" and "obj", which have no joints; equal vertices are joined. In a "dae", the
/// up axis is ignored, as ROS ignores it.
SourceScene read_part(const std::string& content, const std::string& format, const OpenFile& open_file,
                      const ReadLimits& limits);
SourceScene read_urdf(const std::string& content, const ReadLimits& limits);

/// The regular file at a descriptor, which it closes, whole. Throws with one clause.
std::string read_whole(int descriptor, std::uint64_t most);

/// One line that a terminal survives: messages may quote bytes of the file.
std::string one_line(std::string message);

/// Whole content of an open file, from its beginning.
std::string read_descriptor(int descriptor, std::uint64_t most);

}  // namespace sinew::import
