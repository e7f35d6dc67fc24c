#include "render/overlay.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/geometry.h"

namespace sinew::render {
namespace {

struct Color {
  double r, g, b, a = 1;
};

struct Pen {
  cairo_t* cr;
  double unit;  ///< one 720th of the height
  Color text, dim, panel;

  void set(const Color& c) const { cairo_set_source_rgba(cr, c.r, c.g, c.b, c.a); }
  double write(double x, double y, double size, const std::string& s, const Color& c,
               bool bold = false) const {
    cairo_select_font_face(cr, "Inter", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size * unit);
    set(c);
    cairo_move_to(cr, x * unit, y * unit);
    cairo_show_text(cr, s.c_str());
    cairo_text_extents_t e;
    cairo_text_extents(cr, s.c_str(), &e);
    return e.x_advance / unit;
  }
  double width(double size, const std::string& s, bool bold = false) const {
    cairo_select_font_face(cr, "Inter", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size * unit);
    cairo_text_extents_t e;
    cairo_text_extents(cr, s.c_str(), &e);
    return e.x_advance / unit;
  }
  void box(double x, double y, double w, double h) const {
    const double r = 9 * unit;
    x *= unit, y *= unit, w *= unit, h *= unit;
    cairo_new_sub_path(cr);
    cairo_arc(cr, x + w - r, y + r, r, -M_PI / 2, 0);
    cairo_arc(cr, x + w - r, y + h - r, r, 0, M_PI / 2);
    cairo_arc(cr, x + r, y + h - r, r, M_PI / 2, M_PI);
    cairo_arc(cr, x + r, y + r, r, M_PI, 1.5 * M_PI);
    cairo_close_path(cr);
    set(panel);
    cairo_fill(cr);
  }
  void line(double x0, double y0, double x1, double y1, double thick, const Color& c) const {
    set(c);
    cairo_set_line_width(cr, thick * unit);
    cairo_move_to(cr, x0 * unit, y0 * unit);
    cairo_line_to(cr, x1 * unit, y1 * unit);
    cairo_stroke(cr);
  }
};

Color stress(float load) {
  const Vec3<float> c = stress_color(load);
  return {std::pow(double(c.x()), 0.4545), std::pow(double(c.y()), 0.4545), std::pow(double(c.z()), 0.4545),
          1};
}

std::string text(const char* format, double a, double b = 0) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

void state_panel(const Pen& pen, const scene::Recording& rec, std::size_t index) {
  const scene::Frame& frame = rec.frames[index];
  const scene::CharacterFrame& c = frame.characters[0];
  const Skeleton& skeleton = rec.characters[0]->skeleton;
  pen.box(24, 24, 330, 148);
  pen.write(42, 58, 21, rec.title.substr(0, 26), pen.text, true);
  pen.write(284, 58, 15, text("%.2f s", frame.time), pen.dim);
  double us = 0;
  int counted = 0;
  for (std::size_t i = index >= 8 ? index - 8 : 0; i <= index; ++i, ++counted)
    us += double(rec.frames[i].characters[0].microseconds);
  const bool playback = c.unknown_dofs == 0;
  const Color state = playback ? Color{0.36, 0.78, 0.66} : stress(0.8f);
  double x = 42 + pen.write(42, 90, 26, text("%.0f", c.unknown_dofs), state, true);
  x += pen.write(x + 7, 90, 15, text("of %.0f DOFs unknown", c.total_dofs), pen.text) + 7;
  pen.write(x + 9, 90, 15, playback ? "playback" : "solved", state);
  pen.write(42, 116, 15, text("%.0f µs a step", counted ? us / counted : 0), pen.dim);
  pen.write(190, 116, 15, text("strength %.0f %%", 100.0 * double(c.strength)), pen.dim);
  const int j = c.most_loaded_joint;
  const std::string joint = j >= 0 ? skeleton.joints[static_cast<std::size_t>(j)].name : "";
  const float load = j >= 0 ? c.load[static_cast<std::size_t>(j)] : 0;
  pen.write(42, 142, 15, joint.substr(0, 22) + text("  %.0f %% of its limit", 100.0 * double(load)), pen.dim);
  for (int k = 0; k < 60; ++k)  // load bar in the ramp's own colours
    pen.line(42 + 4.9 * k, 157, 42 + 4.9 * (k + 1), 157, 4,
             double(k) / 60 < double(load) ? stress(float(k) / 60) : Color{0.5, 0.5, 0.55, 0.25});
}

void curve_panel(const Pen& pen, const scene::Recording& rec, std::size_t index, double right) {
  const double w = 372, h = 196, x0 = right - w - 24, y0 = 720 - h - 24;
  const Skeleton& skeleton = rec.characters[0]->skeleton;
  int joint = rec.plotted_joint;
  if (joint < 0) {
    std::vector<float> total(skeleton.joints.size(), 0);
    for (const scene::Frame& f : rec.frames)
      for (std::size_t i = 0; i < total.size(); ++i) total[i] += f.characters[0].load[i];
    joint = static_cast<int>(std::max_element(total.begin(), total.end()) - total.begin());
  }
  const auto at = static_cast<std::size_t>(joint);
  pen.box(x0, y0, w, h);
  pen.write(x0 + 18, y0 + 28, 15, "Torque of " + skeleton.joints[at].name.substr(0, 18), pen.text, true);
  const scene::CharacterFrame& now = rec.frames[index].characters[0];
  pen.write(x0 + w - 96, y0 + 28, 14, text("%.0f N·m", double(now.torque[at])), stress(now.load[at]));
  const double span = 5, end = std::max(span, rec.frames[index].time), begin = end - span;
  double top = 1;
  for (const scene::Frame& f : rec.frames)
    top = std::max({top, std::abs(double(f.characters[0].torque[at])) * 1.1});
  double limit_now = 0;
  for (const scene::Frame& f : rec.frames) limit_now = std::max(limit_now, double(f.characters[0].limit[at]));
  if (std::isfinite(limit_now) && limit_now < 3 * top) top = std::max(top, 1.15 * limit_now);
  const double left = x0 + 52, bottom = y0 + 130, height = 88, plot_w = w - 70;
  const auto px = [&](double t) { return left + plot_w * (t - begin) / span; };
  const auto py = [&](double v) { return bottom - height / 2 - height / 2 * std::clamp(v / top, -1.0, 1.0); };
  for (const double v : {top, 0.0, -top}) {
    pen.line(left, py(v), left + plot_w, py(v), 1, {0.6, 0.63, 0.68, v == 0 ? 0.45 : 0.18});
    pen.write(x0 + 14, py(v) + 4, 11, text("%.0f", v), pen.dim);
  }
  const std::size_t step = 1;
  for (std::size_t i = 1; i <= index; i += step) {
    const scene::Frame &a = rec.frames[i - 1], &b = rec.frames[i];
    if (a.time < begin) continue;
    const scene::CharacterFrame &ca = a.characters[0], &cb = b.characters[0];
    if (i % 4 < 2 && std::isfinite(cb.limit[at]) && cb.limit[at] < 3 * top)
      for (const double side : {1.0, -1.0})
        pen.line(px(a.time), py(side * double(ca.limit[at])), px(b.time), py(side * double(cb.limit[at])),
                 1.2, {0.85, 0.8, 0.7, 0.55});
    pen.line(px(a.time), py(double(ca.torque[at])), px(b.time), py(double(cb.torque[at])), 2.2,
             stress(std::max(0.45f, cb.load[at])));
  }
  // Unknown degrees of freedom over the same span.
  const double base = y0 + h - 16;
  pen.write(x0 + 14, base - 2, 11, "DOFs", pen.dim);
  for (std::size_t i = 0; i <= index; ++i) {
    const scene::CharacterFrame& c = rec.frames[i].characters[0];
    if (rec.frames[i].time < begin) continue;
    const double x = px(rec.frames[i].time), share = c.total_dofs ? double(c.unknown_dofs) / c.total_dofs : 0;
    pen.line(x, base, x, base - 1 - 26 * share, plot_w / (span * rec.frame_rate) + 0.4,
             share > 0 ? stress(0.8f) : Color{0.36, 0.78, 0.66, 0.8});
  }
}

}  // namespace

void draw_overlay(const scene::Recording& rec, std::size_t index, bool dark, Image& image) {
  if (rec.frames.empty() || rec.frames[index].characters.empty()) return;
  cairo_surface_t* surface = cairo_image_surface_create_for_data(image.pixels.data(), CAIRO_FORMAT_RGB24,
                                                                 image.width, image.height, image.width * 4);
  cairo_t* cr = cairo_create(surface);
  Pen pen{cr, image.height / 720.0, {}, {}, {}};
  pen.text = dark ? Color{0.95, 0.96, 0.97} : Color{0.12, 0.14, 0.17};
  pen.dim = dark ? Color{0.70, 0.73, 0.77} : Color{0.34, 0.37, 0.42};
  pen.panel = dark ? Color{0.07, 0.08, 0.10, 0.72} : Color{1, 1, 1, 0.78};
  state_panel(pen, rec, index);
  curve_panel(pen, rec, index, image.width / pen.unit);
  if (const std::string& caption = rec.frames[index].caption; !caption.empty()) {
    const double w = pen.width(19, caption) + 40;
    pen.box(24, 720 - 24 - 44, w, 44);
    pen.write(44, 720 - 24 - 16, 19, caption, pen.text);
  }
  cairo_destroy(cr);
  cairo_surface_finish(surface);
  cairo_surface_destroy(surface);
}

}  // namespace sinew::render
