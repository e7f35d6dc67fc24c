// Frames → MP4, WebM or GIF.
#pragma once

#include <memory>
#include <string>

#include "render/image.h"

namespace sinew::render {

/// A video being written. Nothing is left behind without finish(); two runs decode to the same frames.
class VideoWriter {
 public:
  /// By the extension of `path`: .mp4 (H.264, bt709, yuv420p), .webm (VP9) or .gif (one palette for the whole
  /// video). An error in builds without SINEW_VIDEO.
  static std::unique_ptr<VideoWriter> create(const std::string& path, int width, int height, double fps,
                                             int threads, convert::Error& error);
  virtual ~VideoWriter() = default;
  virtual convert::Error add(const Image& frame) = 0;
  virtual convert::Error finish() = 0;
};

}  // namespace sinew::render
