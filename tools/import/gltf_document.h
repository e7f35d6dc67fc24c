// glTF before assimp sees it: its JSON, checked where assimp 5.2.5 does not look, with a name of its own for
// every node, because assimp's channels and bones go by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "import/source_scene.h"

namespace sinew::import {

inline constexpr const char* kFloatsFile = "sinew_floats.bin";

struct GltfDocument {
  std::string content;                        ///< the file again, node k named node_tag(k)
  std::vector<std::string> node_names;        ///< as in the file, perhaps empty or repeated
  std::string extras;                         ///< of the document, as JSON; empty where it has none
  std::vector<std::string> animation_extras;  ///< [animation] the same
  std::string floats;              ///< of what was normalised integers: bytes of file `kFloatsFile`
  std::vector<std::string> notes;  ///< what assimp is known to leave out, one clause each
};

/// Name that node k goes by between here and SceneBuilder, and keeps when the file gives it none.
std::string node_tag(std::size_t k);

/// `read_beside`: bytes of a file that the document names, empty where it cannot be read.
///
/// Throws std::runtime_error with one clause: another version, extensions that it cannot do without, damaged
/// JSON or GLB chunks, nodes with two parents, in a loop or too deep, channels and samplers that point
/// nowhere, key times and values that differ in number.
GltfDocument prepare_gltf(const std::string& content, bool binary, const ReadLimits& limits,
                          const std::function<std::string(const std::string& name)>& read_beside);

}  // namespace sinew::import
