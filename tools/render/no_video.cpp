// Stands in for video.cpp in builds without SINEW_VIDEO.
#include "render/video.h"

namespace sinew::render {

std::unique_ptr<FrameWriter> create_video(const std::string& path, int, int, double, int,
                                          convert::Error& error) {
  error = {path + ": this build has no video (SINEW_VIDEO=OFF); write .png pictures"};
  return nullptr;
}

}  // namespace sinew::render
