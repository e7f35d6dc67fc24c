// The project's own character.
#pragma once

#include "convert/convert.h"

namespace sinew::study {

/// assets/character/mannequin.glb, converted once; null where the file is missing.
const Asset* mannequin();

}  // namespace sinew::study
