// Reads a video back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sinew::render::fixtures {

struct Decoded {
  int width = 0, height = 0;
  double fps = 0;
  std::string pixel_format, color_space, codec;
  std::vector<std::vector<std::uint8_t>> frames;  ///< the planes' visible pixels, one after the other
};

/// Everything that is in the first stream of the file; no frames when it cannot be read.
Decoded decode(const std::string& path);

}  // namespace sinew::render::fixtures
