// Frames → MP4, WebM or GIF.
#pragma once

#include <memory>
#include <string>

#include "render/image.h"

namespace sinew::render {

/// Frames being written. Nothing is left behind without finish().
class FrameWriter {
 public:
  FrameWriter() = default;
  virtual ~FrameWriter() = default;
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;
  virtual convert::Error add(const Image& frame) = 0;
  virtual convert::Error finish() = 0;
};

/// By the extension of `path`: .mp4 (H.264, bt709, yuv420p), .webm (VP9) or .gif (one palette for the whole
/// video). Two runs decode to the same frames. An error in builds without SINEW_VIDEO.
std::unique_ptr<FrameWriter> create_video(const std::string& path, int width, int height, double fps,
                                          int threads, convert::Error& error);

}  // namespace sinew::render
