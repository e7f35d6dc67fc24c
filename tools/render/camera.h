// Where the camera stands in every frame.
#pragma once

#include <vector>

#include "render/stage.h"
#include "scene/recording.h"

namespace sinew::render {

/// One view per recorded frame. The recording's own camera, or one that keeps all characters in the picture:
/// of one that stays, a view that stays; of one that is followed, or of several, distance and height follow a
/// window of past and coming frames, so that it neither lags nor shakes.
/// `aspect` is width / height.
std::vector<View> plan_camera(const scene::Recording& recording, float aspect);

/// Views of a character on its own: framed as above from slightly above, turned by n / `per_revolution` of a
/// full circle in frame n (not at all when it is 0).
std::vector<View> plan_turntable(const scene::Recording& recording, float aspect, int per_revolution);

/// Height of the lowest point of the characters in the first `frames` frames, m.
float lowest_point(const scene::Recording& recording, std::size_t frames);

}  // namespace sinew::render
