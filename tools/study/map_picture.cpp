// Failure maps as pictures, by cairo.
#include <cairo-svg.h>
#include <cairo.h>

#include <cmath>
#include <cstdio>

#include "study/maps.h"

namespace sinew::study {
namespace {

// Four colours that stay apart for the colour-blind (after Okabe and Ito), lightened for black text.
struct Colour {
  double red, green, blue;
};
constexpr Colour kColours[] = {
    {0.62, 0.85, 0.78}, {0.70, 0.84, 0.95}, {0.98, 0.80, 0.45}, {0.90, 0.45, 0.38}, {0.85, 0.85, 0.85}};
constexpr const char* kMeanings[] = {"keeps its energy to 10 %", "loses more than 10 %",
                                     "gains more than 1 %", "explodes or gives up", "cannot do the scene"};

constexpr double kCellWide = 46, kCellHigh = 24, kPanelLeft = 52, kPanelTop = 26, kPanelGap = 18, kHead = 74,
                 kFoot = 50;
constexpr int kPanelsAcross = 3;

struct Canvas {
  cairo_surface_t* surface = nullptr;
  cairo_t* pen = nullptr;

  ~Canvas() {
    cairo_destroy(pen);
    cairo_surface_destroy(surface);
  }
  void text(const std::string& what, double x, double y, double size, double align = 0,
            bool bold = false) const {
    cairo_select_font_face(pen, "Inter", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(pen, size);
    cairo_text_extents_t extents;
    cairo_text_extents(pen, what.c_str(), &extents);
    cairo_move_to(pen, x - align * extents.x_advance, y);
    cairo_show_text(pen, what.c_str());
  }
  void fill(const Colour& colour, double x, double y, double wide, double high) const {
    cairo_set_source_rgb(pen, colour.red, colour.green, colour.blue);
    cairo_rectangle(pen, x, y, wide, high);
    cairo_fill(pen);
    cairo_set_source_rgb(pen, 0.1, 0.1, 0.12);
  }
};

std::string number(double value) {
  if (!std::isfinite(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text,
                std::abs(value) >= 1e4 || (value != 0 && std::abs(value) < 1e-3) ? "%.0e" : "%.2g", value);
  return text;
}

void draw_panel(const Canvas& canvas, const FailureMap& map, std::size_t engine, double x, double y) {
  canvas.text(map.engines[engine].label(), x + kPanelLeft, y + 17, 13, 0, true);
  for (std::size_t s = 0; s < map.steps.size(); ++s) {
    const double top = y + kPanelTop + kCellHigh * double(s);
    char step[32];
    std::snprintf(step, sizeof step, "1/%.0f s", 1 / map.steps[s]);
    canvas.text(step, x + kPanelLeft - 5, top + 16, 11, 1);
    for (std::size_t c = 0; c < map.columns.size(); ++c) {
      const MapCell& cell = map.cell(engine, s, c);
      const double left = x + kPanelLeft + kCellWide * double(c);
      canvas.fill(kColours[static_cast<int>(cell.fate)], left, top, kCellWide - 1, kCellHigh - 1);
      canvas.text(number(cell.energy), left + kCellWide / 2, top + 16, 10, 0.5);
    }
  }
  for (std::size_t c = 0; c < map.columns.size(); ++c)
    canvas.text(number(map.columns[c]), x + kPanelLeft + kCellWide * (double(c) + 0.5),
                y + kPanelTop + kCellHigh * double(map.steps.size()) + 13, 11, 0.5);
}

}  // namespace

convert::Error draw_map(const FailureMap& map, const std::string& file) {
  const double wide = kPanelLeft + kCellWide * double(map.columns.size()) + kPanelGap;
  const double high = kPanelTop + kCellHigh * double(map.steps.size()) + 20 + kPanelGap;
  const int down = (static_cast<int>(map.engines.size()) + kPanelsAcross - 1) / kPanelsAcross;
  const double width = kPanelGap + wide * kPanelsAcross, height = kHead + high * down + kFoot;
  const bool svg = file.size() > 4 && file.substr(file.size() - 4) == ".svg";
  const double scale = svg ? 1 : 2;
  Canvas canvas;
  canvas.surface = svg ? cairo_svg_surface_create(file.c_str(), width, height)
                       : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width * scale),
                                                    static_cast<int>(height * scale));
  canvas.pen = cairo_create(canvas.surface);
  cairo_scale(canvas.pen, scale, scale);
  canvas.fill({1, 1, 1}, 0, 0, width, height);
  canvas.text(map.title, kPanelGap, 28, 18, 0, true);
  canvas.text("down: time step; across: " + map.across + "; number: change of energy " + map.change,
              kPanelGap, 48, 12);
  for (std::size_t e = 0; e < map.engines.size(); ++e)
    draw_panel(canvas, map, e, kPanelGap + wide * double(e % kPanelsAcross),
               kHead - 12 + high * double(e / kPanelsAcross));
  double x = kPanelGap;
  for (int fate = 0; fate < 5; ++fate) {
    canvas.fill(kColours[fate], x, height - 34, 16, 16);
    canvas.text(kMeanings[fate], x + 22, height - 21, 12);
    x += 178;
  }
  cairo_surface_flush(canvas.surface);
  cairo_status_t status = cairo_surface_status(canvas.surface);
  if (!svg && status == CAIRO_STATUS_SUCCESS)
    status = cairo_surface_write_to_png(canvas.surface, file.c_str());
  cairo_surface_finish(canvas.surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(canvas.surface);
  if (status != CAIRO_STATUS_SUCCESS) return {file + ": cannot be drawn: " + cairo_status_to_string(status)};
  return {};
}

}  // namespace sinew::study
