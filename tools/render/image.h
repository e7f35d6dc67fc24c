// Pictures in memory and in files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::render {

enum class Channels {
  kColor,       ///< alpha says nothing
  kColorAlpha,  ///< colours multiplied by alpha, as cairo has them
  kNumber,      ///< a number of 16 bits, its high byte in red, its low one in green
};

/// 8-bit BGRA rows from the top (cairo's order), width·4 bytes each.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  Channels channels = Channels::kColor;
};

/// PNG at `path`: sRGB, with alpha where it counts; numbers as 16-bit grey. Errors call it `name`.
convert::Error write_png(const Image& image, const std::string& path, const std::string& name);

/// PNG or JPEG file bytes to RGBA rows from the top. False when it is neither, or damaged.
bool decode_image(const std::vector<std::uint8_t>& bytes, int& width, int& height,
                  std::vector<std::uint8_t>& rgba);

}  // namespace sinew::render
