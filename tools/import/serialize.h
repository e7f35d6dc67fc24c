// SourceScene ↔ bytes.
#pragma once

#include <string>

#include "import/source_scene.h"

namespace sinew::import {

std::string to_bytes(const SourceScene& scene);

/// False when the bytes are no scene: wrong lengths, indices out of range, parents that do not come first,
/// numbers that are not finite. `error` says which.
bool from_bytes(const std::string& bytes, SourceScene& out, std::string& error);

}  // namespace sinew::import
