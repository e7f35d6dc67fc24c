// What every SourceScene must satisfy before the rest of the program may look at it.
#pragma once

#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// What is wrong with a scene that came from the sandbox, as one clause that names the place; empty when it
/// is sound: every index in range, parents first, node names unique, key times rising, arrays of equal
/// length, every number finite.
std::string fault_in(const SourceScene& scene);

}  // namespace sinew::import
