// cairo with the overlay's colours and units.
#pragma once

#include <string>

#include "render/geometry.h"
#include "render/overlay.h"

// As cairo.h declares them.
typedef struct _cairo cairo_t;                  // NOLINT(bugprone-reserved-identifier)
typedef struct _cairo_surface cairo_surface_t;  // NOLINT(bugprone-reserved-identifier)

namespace sinew::render {

/// sRGB and opacity, 0 … 1.
struct Color {
  double r, g, b, a = 1;
  Color faded(double share) const { return {r, g, b, a * share}; }
};

/// Draws on an image while it lives. Lengths in `unit` pixels.
class Pen {
 public:
  Pen(Image& image, double unit, bool dark);
  ~Pen();
  Pen(const Pen&) = delete;
  Pen& operator=(const Pen&) = delete;

  Color text, dim, faint, panel, calm, warm;  ///< of the theme

  /// Colour of the load ramp, readable on a panel.
  Color stress(float load) const;

  void box(const Rect& at) const;
  /// A rounded label; returns its width.
  double badge(double x, double y, double size, const std::string& s, const Color& color) const;
  /// Baseline at y; returns the advance.
  double write(double x, double y, double size, const std::string& s, const Color& color,
               bool bold = false) const;
  void write_right(double x, double y, double size, const std::string& s, const Color& color,
                   bool bold = false) const;
  double width(double size, const std::string& s, bool bold = false) const;
  /// `s`, shortened with an ellipsis to the width.
  std::string fitted(double size, std::string s, double most, bool bold = false) const;
  void line(double x0, double y0, double x1, double y1, double thick, const Color& color) const;
  /// The load ramp from left to right, up to `share` of its length; the rest faint.
  void ramp(const Rect& at, double share) const;
  void fill(const Rect& at, const Color& color) const;

  cairo_t* cairo() const { return cairo_; }
  double unit() const { return unit_; }
  void set(const Color& color) const;

 private:
  void rounded(const Rect& at, double radius) const;
  void font(double size, bool bold) const;

  cairo_surface_t* surface_;
  cairo_t* cairo_;
  double unit_;
  bool dark_;
};

}  // namespace sinew::render
