// glTF's normalised integers, which assimp 5.2.5 takes for floats as they stand (its issues 4587 and 6130).
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// Every accessor of normalised integers (skin weights as Unreal writes them, packed rotations, colours)
/// becomes one of floats, in a buffer that is added: its bytes are returned, its name is `file`. Empty where
/// there are none. `bytes_of`: a buffer's bytes, by its number.
///
/// Throws std::runtime_error with one clause: accessors that reach beyond their buffer, sparse ones.
std::string widen_normalized(nlohmann::json& document,
                             const std::function<std::string(std::size_t)>& bytes_of, const std::string& file,
                             const ReadLimits& limits);

}  // namespace sinew::import
