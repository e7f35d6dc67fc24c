// A sheet of white paper for cairo, as PNG (at twice the size) or SVG by the file's ending.
#pragma once

#include <cairo.h>

#include <string>

#include "convert/convert.h"

namespace sinew::study {

struct Colour {
  double red, green, blue;  ///< 0 … 1
};

class Canvas {
 public:
  Canvas(const std::string& file, double width, double height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  cairo_t* pen() const { return pen_; }
  void set(const Colour& colour) const { cairo_set_source_rgb(pen_, colour.red, colour.green, colour.blue); }
  /// In ink; `align` 0: starts at x, 0.5: centred, 1: ends there.
  void text(const std::string& what, double x, double y, double size, double align = 0,
            bool bold = false) const;
  void fill(const Colour& colour, double x, double y, double wide, double high) const;
  /// Writes the file.
  convert::Error finish();

 private:
  std::string file_;
  bool svg_;
  cairo_surface_t* surface_;
  cairo_t* pen_;
};

}  // namespace sinew::study
