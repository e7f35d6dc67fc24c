// Frames → MP4, WebM or GIF through libav.
#pragma once

#include <memory>
#include <string>

#include "render/image.h"

namespace sinew::render {

/// H.264 (bt709, yuv420p), VP9 or GIF by the file's extension. Fixed thread count and bit-exact flags: two
/// runs decode to the same frames. Writes beside `path` and renames in finish(); without finish() nothing is
/// left.
class VideoWriter {
 public:
  static std::unique_ptr<VideoWriter> create(const std::string& path, int width, int height, double fps,
                                             int threads, convert::Error& error);
  ~VideoWriter();
  convert::Error add(const Image& frame);
  convert::Error finish();

 private:
  VideoWriter();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::render
