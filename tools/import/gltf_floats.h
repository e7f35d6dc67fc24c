// Floats that assimp 5.2.5 needs beside a glTF's own: it takes normalised integers for floats as they stand
// (its issues 4587 and 6130), and crashes on skins without bind matrices.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// Every accessor of normalised integers (skin weights as Unreal writes them, packed rotations, colours)
/// becomes one of floats, and every skin without bind matrices gets matrices of 1, as the specification says,
/// in a buffer that is added: its bytes are returned, its name is `file`. Empty where there are none.
/// `bytes_of`: a buffer's bytes, by its number.
///
/// Throws std::runtime_error with one clause: accessors that reach beyond their buffer, sparse ones.
std::string add_floats(nlohmann::json& document, const std::function<std::string(std::size_t)>& bytes_of,
                       const std::string& file, const ReadLimits& limits);

}  // namespace sinew::import
