// The x-ray look: bones, and muscles as spindles coloured by the load of the joint that they move.
#pragma once

#include "render/geometry.h"

namespace sinew::render {

/// Trunk muscles by the joints' roles where the skeleton has a chest and a pelvis, three spindles around
/// every other bone. Sizes follow the skeleton's shapes.
void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out);

}  // namespace sinew::render
