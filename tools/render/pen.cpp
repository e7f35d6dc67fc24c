#include "render/pen.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>

namespace sinew::render {

Pen::Pen(Image& image, double unit, bool dark)
    : surface_(cairo_image_surface_create_for_data(image.pixels.data(), CAIRO_FORMAT_RGB24, image.width,
                                                   image.height, image.width * 4)),
      cairo_(cairo_create(surface_)),
      unit_(unit),
      dark_(dark) {
  text = dark ? Color{0.95, 0.96, 0.97} : Color{0.10, 0.12, 0.15};
  dim = dark ? Color{0.68, 0.72, 0.77} : Color{0.32, 0.36, 0.42};
  faint = dark ? Color{0.62, 0.68, 0.76, 0.22} : Color{0.30, 0.35, 0.42, 0.22};
  panel = dark ? Color{0.045, 0.055, 0.075, 0.74} : Color{1, 1, 1, 0.82};
  calm = dark ? Color{0.38, 0.80, 0.72} : Color{0.03, 0.47, 0.43};
  warm = dark ? Color{1.00, 0.70, 0.25} : Color{0.76, 0.36, 0.02};
}

Pen::~Pen() {
  cairo_destroy(cairo_);
  cairo_surface_finish(surface_);
  cairo_surface_destroy(surface_);
}

Color Pen::stress(float load) const {
  const Vec3<float> c = stress_color(load);
  const double bright = dark_ ? 1.25 : 0.92;
  const auto shown = [&](float linear) { return std::min(1.0, bright * std::pow(double(linear), 1 / 2.2)); };
  return {shown(c.x()), shown(c.y()), shown(c.z())};
}

void Pen::set(const Color& c) const {
  cairo_set_source_rgba(cairo_, c.r, c.g, c.b, c.a);
}

void Pen::font(double size, bool bold) const {
  cairo_select_font_face(cairo_, "Inter", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, size * unit_);
}

double Pen::width(double size, const std::string& s, bool bold) const {
  font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, s.c_str(), &extents);
  return extents.x_advance / unit_;
}

double Pen::write(double x, double y, double size, const std::string& s, const Color& color,
                  bool bold) const {
  const double advance = width(size, s, bold);
  set(color);
  cairo_move_to(cairo_, x * unit_, y * unit_);
  cairo_show_text(cairo_, s.c_str());
  return advance;
}

void Pen::write_right(double x, double y, double size, const std::string& s, const Color& color,
                      bool bold) const {
  write(x - width(size, s, bold), y, size, s, color, bold);
}

std::string Pen::fitted(double size, std::string s, double most, bool bold) const {
  if (width(size, s, bold) <= most) return s;
  while (!s.empty() && width(size, s + "…", bold) > most) {
    while (!s.empty() && (static_cast<unsigned char>(s.back()) & 0xC0) == 0x80) s.pop_back();  // UTF-8 tail
    if (!s.empty()) s.pop_back();
  }
  return s + "…";
}

void Pen::rounded(const Rect& at, double radius) const {
  const double r = radius * unit_, x = at.x * unit_, y = at.y * unit_, w = at.width * unit_,
               h = at.height * unit_;
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, x + w - r, y + r, r, -M_PI / 2, 0);
  cairo_arc(cairo_, x + w - r, y + h - r, r, 0, M_PI / 2);
  cairo_arc(cairo_, x + r, y + h - r, r, M_PI / 2, M_PI);
  cairo_arc(cairo_, x + r, y + r, r, M_PI, 1.5 * M_PI);
  cairo_close_path(cairo_);
}

void Pen::box(const Rect& at) const {
  rounded(at, 10);
  set(panel);
  cairo_fill_preserve(cairo_);
  set(faint);
  cairo_set_line_width(cairo_, unit_);
  cairo_stroke(cairo_);
}

double Pen::badge(double x, double y, double size, const std::string& s, const Color& color) const {
  const Rect at{x, y - 1.12 * size, width(size, s, true) + 1.3 * size, 1.55 * size};
  rounded(at, at.height / 2);
  set(color.faded(0.20));
  cairo_fill(cairo_);
  write(x + 0.65 * size, y, size, s, color, true);
  return at.width;
}

void Pen::line(double x0, double y0, double x1, double y1, double thick, const Color& color) const {
  set(color);
  cairo_set_line_width(cairo_, thick * unit_);
  cairo_move_to(cairo_, x0 * unit_, y0 * unit_);
  cairo_line_to(cairo_, x1 * unit_, y1 * unit_);
  cairo_stroke(cairo_);
}

void Pen::ramp(const Rect& at, double share) const {
  cairo_pattern_t* colors = cairo_pattern_create_linear(at.x * unit_, 0, (at.x + at.width) * unit_, 0);
  for (int k = 0; k <= 16; ++k) {
    const Color c = stress(float(k) / 16);
    cairo_pattern_add_color_stop_rgb(colors, k / 16.0, c.r, c.g, c.b);
  }
  const double filled = at.width * std::clamp(share, 0.0, 1.0);
  cairo_set_source(cairo_, colors);
  cairo_rectangle(cairo_, at.x * unit_, at.y * unit_, filled * unit_, at.height * unit_);
  cairo_fill(cairo_);
  cairo_pattern_destroy(colors);
  fill({at.x + filled, at.y, at.width - filled, at.height}, faint);
}

void Pen::fill(const Rect& at, const Color& color) const {
  set(color);
  cairo_rectangle(cairo_, at.x * unit_, at.y * unit_, at.width * unit_, at.height * unit_);
  cairo_fill(cairo_);
}

}  // namespace sinew::render
