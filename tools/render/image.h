// Pictures in memory and in files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::render {

/// 8-bit BGRA rows from the top (cairo's order), width·4 bytes each.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// sRGB PNG at `path`; errors call it `name`.
convert::Error write_png(const Image& image, const std::string& path, const std::string& name);

/// PNG or JPEG file bytes to RGBA rows from the top. False when it is neither, or damaged.
bool decode_image(const std::vector<std::uint8_t>& bytes, int& width, int& height,
                  std::vector<std::uint8_t>& rgba);

}  // namespace sinew::render
