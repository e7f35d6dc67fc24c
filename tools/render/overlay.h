// Text and curves over a frame, by cairo.
#pragma once

#include <array>

#include "render/image.h"
#include "scene/recording.h"

namespace sinew::render {

struct Rect {
  double x = 0, y = 0, width = 0, height = 0;
};

/// Where the overlay's parts stand, in units of `unit` pixels: 720ths of the height, smaller in narrow
/// pictures. Parts never overlap.
struct Layout {
  double unit, width, height;  ///< picture size in units
  Rect state, legend, chart, timeline;
  Rect cast;     ///< room for a row per character where there are several
  Rect caption;  ///< the room that it has; its panel takes what it needs from the lower left corner

  Layout(int pixels_wide, int pixels_high);
  std::array<Rect, 6> parts() const { return {state, legend, chart, timeline, cast, caption}; }
};

/// Frame `index` of the recording: state, load ramp and torque against its limit of the first character, a
/// row for each where there are several, unknown DOFs of all over the whole time, caption.
void draw_overlay(const scene::Recording& recording, std::size_t index, bool dark, Image& image);

/// What the asset is: name, joints, degrees of freedom, mass, clips.
void draw_title(const Asset& asset, bool dark, Image& image);

}  // namespace sinew::render
