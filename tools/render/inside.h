// The runtime's debug drawing over a picture: seen through everything.
#pragma once

#include "render/image.h"
#include "render/stage.h"
#include "scene/drawing.h"

namespace sinew::render {

/// Over a picture that was taken with this view. Triangles first, then lines, then words. What is behind the
/// eye is left out.
void draw_inside(const scene::Drawing& drawing, const View& view, bool dark, Image& image);

}  // namespace sinew::render
