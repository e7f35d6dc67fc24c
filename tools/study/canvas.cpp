#include "study/canvas.h"

#include <cairo.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "study/words.h"

namespace sinew::study {
namespace {

constexpr Colour kInk{0.1, 0.1, 0.12};
constexpr double kScale = 2;  // pixels of a PNG per unit
constexpr double kDash[] = {4, 3};

std::string hex(const Colour& colour) {
  const auto part = [](double share) { return static_cast<int>(std::lround(255 * share)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(colour.red), part(colour.green), part(colour.blue));
}

void set(cairo_t* pen, const Colour& colour) {
  cairo_set_source_rgb(pen, colour.red, colour.green, colour.blue);
}

void set_font(cairo_t* pen, double size, bool bold) {
  cairo_select_font_face(pen, "Inter", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, size);
}

double advance(cairo_t* pen, const std::string& what) {
  cairo_text_extents_t extents;
  cairo_text_extents(pen, what.c_str(), &extents);
  return extents.x_advance;
}

}  // namespace

struct Canvas::Pen {
  cairo_surface_t* sheet;
  cairo_t* to;

  Pen(cairo_format_t format, double width, double height, double scale)
      : sheet(cairo_image_surface_create(format, static_cast<int>(width * scale),
                                         static_cast<int>(height * scale))),
        to(cairo_create(sheet)) {
    cairo_scale(to, scale, scale);
  }
  ~Pen() {
    cairo_destroy(to);
    cairo_surface_destroy(sheet);
  }
  Pen(const Pen&) = delete;
  Pen& operator=(const Pen&) = delete;
};

Canvas::Canvas(const std::string& file, double width, double height)
    : file_(file), svg_(!file.ends_with(".png")), width_(width), height_(height) {
  if (!svg_) pen_ = std::make_unique<Pen>(CAIRO_FORMAT_RGB24, width, height, kScale);
  fill({1, 1, 1}, 0, 0, width, height);
}

Canvas::~Canvas() = default;

double Canvas::width_of(const std::string& what, double size, bool bold) {
  const Pen pen(CAIRO_FORMAT_A8, 1, 1, 1);
  set_font(pen.to, size, bold);
  return advance(pen.to, what);
}

void Canvas::text(const std::string& what, double x, double y, double size, double align, bool bold) {
  if (svg_) {
    body_ += fmt::format("<text x='{:.1f}' y='{:.1f}' font-size='{:g}'{}{}>{}</text>\n", x, y, size,
                         align == 0     ? ""
                         : align == 0.5 ? " text-anchor='middle'"
                                        : " text-anchor='end'",
                         bold ? " font-weight='bold'" : "", escaped(what));
    return;
  }
  set(pen_->to, kInk);
  set_font(pen_->to, size, bold);
  cairo_move_to(pen_->to, x - align * advance(pen_->to, what), y);
  cairo_show_text(pen_->to, what.c_str());
  cairo_new_path(pen_->to);  // text leaves a point behind
}

void Canvas::fill(const Colour& colour, double x, double y, double wide, double high) {
  if (svg_) {
    body_ += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>\n", x, y,
                         wide, high, hex(colour));
    return;
  }
  set(pen_->to, colour);
  cairo_rectangle(pen_->to, x, y, wide, high);
  cairo_fill(pen_->to);
}

void Canvas::line(const Colour& colour, double width, const std::vector<Spot>& through, bool dashed) {
  if (svg_) {
    std::string points;
    for (const Spot& s : through) points += fmt::format("{:.1f},{:.1f} ", s.x, s.y);
    if (!points.empty()) points.pop_back();
    body_ += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='{:g}'{}/>\n", points,
                         hex(colour), width,
                         dashed ? fmt::format(" stroke-dasharray='{:g} {:g}'", kDash[0], kDash[1]) : "");
    return;
  }
  set(pen_->to, colour);
  cairo_set_line_width(pen_->to, width);
  cairo_set_dash(pen_->to, kDash, dashed ? 2 : 0, 0);
  for (const Spot& s : through) cairo_line_to(pen_->to, s.x, s.y);
  cairo_stroke(pen_->to);
  cairo_set_dash(pen_->to, nullptr, 0, 0);
}

void Canvas::dot(const Colour& colour, const Spot& centre, double radius, const std::string& tip) {
  if (svg_) {
    body_ += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{:g}' fill='{}'", centre.x, centre.y, radius,
                         hex(colour));
    body_ += tip.empty() ? "/>\n" : "><title>" + escaped(tip) + "</title></circle>\n";
    return;
  }
  set(pen_->to, colour);
  cairo_arc(pen_->to, centre.x, centre.y, radius, 0, 7);
  cairo_fill(pen_->to);
}

void Canvas::ring(const Colour& colour, const Spot& centre, double radius) {
  if (svg_) {
    body_ += fmt::format(
        "<circle cx='{:.1f}' cy='{:.1f}' r='{:g}' fill='none' stroke='{}' stroke-width='1.8' "
        "pointer-events='none'/>\n",
        centre.x, centre.y, radius, hex(colour));
    return;
  }
  set(pen_->to, colour);
  cairo_set_line_width(pen_->to, 1.8);
  cairo_arc(pen_->to, centre.x, centre.y, radius, 0, 7);
  cairo_stroke(pen_->to);
}

void Canvas::group(const std::string& name) {
  if (!svg_) return;
  if (grouped_) body_ += "</g>\n";
  grouped_ = !name.empty();
  if (grouped_) body_ += "<g data-line='" + escaped(name) + "'>\n";
}

std::string Canvas::svg() const {
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:g} {1:g}' width='{0:g}' height='{1:g}' "
             "font-family='Inter, system-ui, sans-serif' fill='{2}'>\n",
             width_, height_, hex(kInk)) +
         body_ + (grouped_ ? "</g>\n" : "") + "</svg>\n";
}

convert::Error Canvas::finish() {
  if (svg_) {
    if (file_.empty()) return {};
    std::ofstream out(file_);
    out << svg();
    out.close();
    return out ? convert::Error{} : convert::Error{file_ + ": cannot be written"};
  }
  cairo_surface_flush(pen_->sheet);
  cairo_status_t status = cairo_surface_status(pen_->sheet);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_write_to_png(pen_->sheet, file_.c_str());
  if (status != CAIRO_STATUS_SUCCESS) return {file_ + ": cannot be drawn: " + cairo_status_to_string(status)};
  return {};
}

}  // namespace sinew::study
