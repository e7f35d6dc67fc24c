// The x-ray look: bones, and muscles as spindles coloured by the load of the joint that they move.
#pragma once

#include "render/geometry.h"

namespace sinew::render {

/// Bones from joint to joint; muscles of trunk and limbs by the joints' roles, and three spindles around
/// every shape whose role is unknown. Sizes follow the skeleton's shapes.
void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out);

}  // namespace sinew::render
