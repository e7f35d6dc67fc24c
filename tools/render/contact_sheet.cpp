#include "render/contact_sheet.h"

#include <cairo.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "render/image.h"
#include "render/pen.h"

namespace sinew::render {
namespace {

constexpr int kCell = 240, kTitle = 28, kGap = 12;  // pixels
constexpr double kText = 13;
constexpr std::size_t kPerSheet = 100;

std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Draws a picture file as large as fits into a square. False: it is none.
bool draw_picture(const Pen& pen, const std::string& path, double x, double y) {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  if (path.empty() || !decode_image(bytes_of(path), width, height, pixels)) return false;
  for (std::size_t k = 0; k + 3 < pixels.size(); k += 4)
    std::swap(pixels[k], pixels[k + 2]);  // cairo's order
  cairo_surface_t* surface =
      cairo_image_surface_create_for_data(pixels.data(), CAIRO_FORMAT_RGB24, width, height, width * 4);
  const double scale = double(kCell) / std::max(width, height);
  cairo_t* cairo = pen.cairo();
  cairo_save(cairo);
  cairo_translate(cairo, x + (kCell - scale * width) / 2, y + (kCell - scale * height) / 2);
  cairo_scale(cairo, scale, scale);
  cairo_set_source_surface(cairo, surface, 0, 0);
  cairo_paint(cairo);
  cairo_restore(cairo);
  cairo_surface_destroy(surface);
  return true;
}

/// Words in lines of a cell's width, from its top.
void draw_fault(const Pen& pen, const std::string& fault, double x, double y) {
  constexpr double kLine = 18;
  double at = y + 2 * kLine;
  std::string line;
  for (std::size_t begin = 0; begin < fault.size() && at < y + kCell;) {
    const std::size_t end = std::min(fault.find(' ', begin), fault.size());
    const std::string longer = line + (line.empty() ? "" : " ") + fault.substr(begin, end - begin);
    if (!line.empty() && pen.width(kText, longer) > kCell - 2 * kGap) {
      pen.write(x + kGap, at, kText, pen.fitted(kText, line, kCell - 2 * kGap), pen.warm);
      at += kLine;
      line = fault.substr(begin, end - begin);
    } else {
      line = longer;
    }
    begin = end + 1;
  }
  pen.write(x + kGap, at, kText, pen.fitted(kText, line, kCell - 2 * kGap), pen.warm);
}

Image sheet_of(const SheetEntry* entries, std::size_t count) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(double(count))));
  const int rows = (static_cast<int>(count) + columns - 1) / columns;
  Image image;
  image.width = columns * (kCell + kGap) + kGap;
  image.height = rows * (kCell + kTitle + kGap) + kGap;
  image.pixels.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4,
                      255);
  const Pen pen(image, 1, true);
  pen.fill({0, 0, double(image.width), double(image.height)}, {0.07, 0.08, 0.10});
  for (int k = 0; k < static_cast<int>(count); ++k) {
    const SheetEntry& entry = entries[k];
    const int row = k / columns, column = k % columns;
    const double x = kGap + column * (kCell + kGap), y = kGap + row * (kCell + kTitle + kGap);
    if (!draw_picture(pen, entry.picture, x, y)) draw_fault(pen, entry.fault, x, y);
    pen.write(x, y + kCell + 0.7 * kTitle, kText, pen.fitted(kText, entry.title, kCell), pen.text);
  }
  return image;
}

}  // namespace

convert::Error write_contact_sheets(const std::vector<SheetEntry>& entries, const std::string& output,
                                    std::vector<std::string>& written) {
  const std::filesystem::path path = output;
  for (std::size_t begin = 0; begin < entries.size(); begin += kPerSheet) {
    const std::size_t number = begin / kPerSheet + 1;
    std::filesystem::path name = path;
    if (number > 1)
      name.replace_filename(path.stem().string() + "_" + std::to_string(number) + path.extension().string());
    const std::string temporary = name.string() + ".tmp" + std::to_string(getpid());
    const Image image = sheet_of(&entries[begin], std::min(kPerSheet, entries.size() - begin));
    if (convert::Error error = write_png(image, temporary, name.string())) return error;
    std::error_code code;
    std::filesystem::rename(temporary, name, code);
    if (code) return {name.string() + ": cannot be written: " + code.message()};
    written.push_back(name.string());
  }
  return {};
}

}  // namespace sinew::render
