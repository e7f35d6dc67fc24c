// A sheet of white paper: PNG by cairo (at twice the size), or SVG whose text stays text.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::study {

struct Colour {
  double red, green, blue;  ///< 0 … 1
};

/// A place on the sheet, from its upper left corner.
struct Spot {
  double x, y;
};

/// All lengths in units of the sheet.
class Canvas {
 public:
  /// By the file's ending: .png, or SVG. An empty name: SVG that svg() returns and nothing writes.
  Canvas(const std::string& file, double width, double height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// In ink; `align` 0: starts at x, 0.5: centred, 1: ends there.
  void text(const std::string& what, double x, double y, double size, double align = 0, bool bold = false);
  void fill(const Colour& colour, double x, double y, double wide, double high);
  void line(const Colour& colour, double width, const std::vector<Spot>& through, bool dashed = false);
  /// `tip`: what SVG shows to whoever points at it; may be empty.
  void dot(const Colour& colour, const Spot& centre, double radius, const std::string& tip = {});
  void ring(const Colour& colour, const Spot& centre, double radius);
  /// What follows belongs together under a name that a script can look for (SVG's data-line); ends with an
  /// empty name.
  void group(const std::string& name);
  /// Writes the file, if it has a name.
  convert::Error finish();
  /// The whole element.
  std::string svg() const;

  /// How wide a text will be.
  static double width_of(const std::string& what, double size, bool bold = false);

 private:
  struct Pen;

  std::string file_;
  bool svg_;
  double width_, height_;
  std::string body_;
  bool grouped_ = false;
  std::unique_ptr<Pen> pen_;  ///< of a PNG
};

}  // namespace sinew::study
