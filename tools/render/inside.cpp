#include "render/inside.h"

#include <cairo.h>

#include <array>
#include <cmath>
#include <optional>

#include "render/overlay.h"
#include "render/pen.h"

namespace sinew::render {
namespace {

constexpr float kNearest = 0.05f;  ///< m before the eye, of a figure of human size
constexpr double kWords = 11;      ///< units, their height
constexpr double kWide = 1.6;      ///< units, lines

/// What Stage does with places, in pixels of the picture.
class Lens {
 public:
  Lens(const View& view, const Image& image)
      : eye_(view.eye),
        near_(kNearest * view.unit),
        shift_(view.shift),
        half_{image.width / 2.0, image.height / 2.0} {
    back_ = (view.eye - view.target).normalized();
    side_ = Vec3<float>::UnitZ().cross(back_);
    side_ = side_.norm() > 1e-4f ? Vec3<float>(side_.normalized()) : Vec3<float>(Vec3<float>::UnitX());
    up_ = back_.cross(side_);
    scale_ = half_[1] / std::tan(double(view.vertical_fov) / 2);
  }

  /// m before the eye.
  float depth(const Vec3<float>& place) const { return back_.dot(eye_ - place); }
  bool sees(const Vec3<float>& place) const { return depth(place) > near_; }
  /// Of what it sees.
  std::array<double, 2> pixel(const Vec3<float>& place) const {
    const Vec3<float> from_eye = place - eye_;
    const double by_depth = scale_ / double(depth(place));
    return {half_[0] * (1 + double(shift_)) + by_depth * double(side_.dot(from_eye)),
            half_[1] - by_depth * double(up_.dot(from_eye))};
  }
  /// The part of a line that it sees.
  bool cut(Vec3<float>& a, Vec3<float>& b) const {
    const float before = depth(a) - near_, after = depth(b) - near_;
    if (before <= 0 && after <= 0) return false;
    const Vec3<float> between = a + (b - a) * (before / (before - after));
    if (before <= 0) a = between;
    if (after <= 0) b = between;
    return true;
  }

 private:
  Vec3<float> eye_, back_, side_, up_;
  float near_, shift_;
  std::array<double, 2> half_;
  double scale_ = 1;
};

Color shown(const DebugColor& c) {
  return {c.r / 255.0, c.g / 255.0, c.b / 255.0, c.a / 255.0};
}

}  // namespace

void draw_inside(const scene::Drawing& drawing, const View& view, bool dark, Image& image) {
  const Layout layout(image.width, image.height);
  const Pen pen(image, layout.unit, dark);
  const Lens lens(view, image);
  cairo_t* const cr = pen.cairo();
  for (const auto& t : drawing.triangles) {
    if (!lens.sees(t.a) || !lens.sees(t.b) || !lens.sees(t.c)) continue;
    cairo_new_path(cr);
    for (const Vec3<float>& corner : {t.a, t.b, t.c})
      cairo_line_to(cr, lens.pixel(corner)[0], lens.pixel(corner)[1]);
    pen.set(shown(t.color));
    cairo_fill(cr);
  }
  for (auto l : drawing.lines) {
    if (!lens.cut(l.from, l.to)) continue;
    const auto a = lens.pixel(l.from), b = lens.pixel(l.to);
    const double u = layout.unit;
    pen.line(a[0] / u, a[1] / u, b[0] / u, b[1] / u, kWide, shown(l.color));
  }
  for (const auto& w : drawing.words)
    if (lens.sees(w.at)) {
      const auto at = lens.pixel(w.at);
      pen.write(at[0] / layout.unit - pen.width(kWords, w.words) / 2, at[1] / layout.unit, kWords, w.words,
                shown(w.color));
    }
}

}  // namespace sinew::render
