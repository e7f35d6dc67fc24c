#include "study/canvas.h"

#include <cairo-svg.h>

namespace sinew::study {

Canvas::Canvas(const std::string& file, double width, double height)
    : file_(file), svg_(file.ends_with(".svg")) {
  const double scale = svg_ ? 1 : 2;
  surface_ = svg_ ? cairo_svg_surface_create(file.c_str(), width, height)
                  : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width * scale),
                                               static_cast<int>(height * scale));
  pen_ = cairo_create(surface_);
  cairo_scale(pen_, scale, scale);
  fill({1, 1, 1}, 0, 0, width, height);
}

Canvas::~Canvas() {
  cairo_destroy(pen_);
  cairo_surface_destroy(surface_);
}

void Canvas::text(const std::string& what, double x, double y, double size, double align, bool bold) const {
  set({0.1, 0.1, 0.12});
  cairo_select_font_face(pen_, "Inter", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen_, size);
  cairo_text_extents_t extents;
  cairo_text_extents(pen_, what.c_str(), &extents);
  cairo_move_to(pen_, x - align * extents.x_advance, y);
  cairo_show_text(pen_, what.c_str());
}

void Canvas::fill(const Colour& colour, double x, double y, double wide, double high) const {
  set(colour);
  cairo_rectangle(pen_, x, y, wide, high);
  cairo_fill(pen_);
}

convert::Error Canvas::finish() {
  cairo_surface_flush(surface_);
  cairo_status_t status = cairo_surface_status(surface_);
  if (!svg_ && status == CAIRO_STATUS_SUCCESS) status = cairo_surface_write_to_png(surface_, file_.c_str());
  cairo_surface_finish(surface_);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_);
  if (status != CAIRO_STATUS_SUCCESS) return {file_ + ": cannot be drawn: " + cairo_status_to_string(status)};
  return {};
}

}  // namespace sinew::study
