// GIF with a palette of its own, by libavfilter.
#pragma once

#include <memory>

#include "render/video.h"

namespace sinew::render {

/// The palette is known only after the last frame: frames wait, compressed, in memory (about a tenth of
/// width·height·4 bytes each) and are written by finish().
std::unique_ptr<FrameWriter> create_gif(const std::string& path, int width, int height, double fps,
                                        convert::Error& error);

}  // namespace sinew::render
