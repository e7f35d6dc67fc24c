#include "render/image.h"

#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>

namespace sinew::render {
namespace {

struct JpegError {
  jpeg_error_mgr base;
  std::jmp_buf escape;
};

bool decode_jpeg(const std::vector<std::uint8_t>& bytes, int& width, int& height,
                 std::vector<std::uint8_t>& rgba) {
  jpeg_decompress_struct jpeg{};
  JpegError error{};
  jpeg.err = jpeg_std_error(&error.base);
  error.base.error_exit = [](j_common_ptr info) {
    std::longjmp(reinterpret_cast<JpegError*>(info->err)->escape, 1);
  };
  error.base.output_message = [](j_common_ptr) {};
  std::vector<std::uint8_t> row;
  if (setjmp(error.escape) != 0) {
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&jpeg, TRUE);
  if (jpeg.image_width > 8192 || jpeg.image_height > 8192) std::longjmp(error.escape, 1);
  jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&jpeg);
  width = static_cast<int>(jpeg.output_width);
  height = static_cast<int>(jpeg.output_height);
  rgba.resize(std::size_t(width) * std::size_t(height) * 4);
  row.resize(std::size_t(width) * 3);
  while (jpeg.output_scanline < jpeg.output_height) {
    const std::size_t y = jpeg.output_scanline;
    JSAMPROW rows[1] = {row.data()};
    jpeg_read_scanlines(&jpeg, rows, 1);
    for (std::size_t x = 0; x < std::size_t(width); ++x) {
      std::uint8_t* to = &rgba[(y * std::size_t(width) + x) * 4];
      std::memcpy(to, &row[3 * x], 3);
      to[3] = 255;
    }
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return true;
}

/// A row of pixels in PNG's order.
void write_row(const std::uint8_t* bgra, std::size_t width, Channels channels, std::uint8_t* out) {
  for (const std::uint8_t* end = bgra + 4 * width; bgra != end; bgra += 4) {
    const int alpha = channels == Channels::kColorAlpha ? bgra[3] : 255;
    const int last = channels == Channels::kNumber ? 1 : 0;  // red and green only
    for (int k = 2; k >= last; --k)
      *out++ = static_cast<std::uint8_t>(alpha == 0 ? 0 : std::min(255, (bgra[k] * 255 + alpha / 2) / alpha));
    if (channels == Channels::kColorAlpha) *out++ = static_cast<std::uint8_t>(alpha);
  }
}

}  // namespace

bool decode_image(const std::vector<std::uint8_t>& bytes, int& width, int& height,
                  std::vector<std::uint8_t>& rgba) {
  if (bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8)
    return decode_jpeg(bytes, width, height, rgba);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return false;
  if (png.width > 8192 || png.height > 8192) {
    png_image_free(&png);
    return false;
  }
  png.format = PNG_FORMAT_RGBA;
  width = static_cast<int>(png.width);
  height = static_cast<int>(png.height);
  rgba.resize(PNG_IMAGE_SIZE(png));
  return png_image_finish_read(&png, nullptr, rgba.data(), 0, nullptr) != 0;
}

convert::Error write_png(const Image& image, const std::string& path, const std::string& name) {
  FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return {name + ": cannot be written"};
  std::vector<std::uint8_t> row(std::size_t(image.width) * 4);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png)) != 0) {
    if (png) png_destroy_write_struct(&png, &info);
    std::fclose(file);
    return {name + ": cannot be written"};
  }
  png_init_io(png, file);
  const bool number = image.channels == Channels::kNumber;
  const int kind = number
                       ? PNG_COLOR_TYPE_GRAY
                       : (image.channels == Channels::kColorAlpha ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               number ? 16 : 8, kind, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!number) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 3);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = &image.pixels[std::size_t(y) * std::size_t(image.width) * 4];
    write_row(from, std::size_t(image.width), image.channels, row.data());
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return std::fclose(file) == 0 ? convert::Error{} : convert::Error{name + ": cannot be written"};
}

}  // namespace sinew::render
