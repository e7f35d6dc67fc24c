// Text and curves over a frame, by cairo.
#pragma once

#include "render/image.h"
#include "scene/recording.h"

namespace sinew::render {

/// Draws the panels for frame `index` of the recording: state, unknown DOFs over time, torque against its
/// limit, caption.
void draw_overlay(const scene::Recording& recording, std::size_t index, bool dark, Image& image);

}  // namespace sinew::render
