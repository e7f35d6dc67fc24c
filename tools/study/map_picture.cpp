// Failure maps as pictures.
#include <cmath>
#include <cstdio>

#include "study/canvas.h"
#include "study/maps.h"

namespace sinew::study {
namespace {

// Four colours that stay apart for the colour-blind (after Okabe and Ito), lightened for black text.
constexpr Colour kColours[] = {
    {0.62, 0.85, 0.78}, {0.70, 0.84, 0.95}, {0.98, 0.80, 0.45}, {0.90, 0.45, 0.38}, {0.85, 0.85, 0.85}};
constexpr const char* kMeanings[] = {"keeps its energy to 10 %", "loses more than 10 %",
                                     "gains more than 1 %", "explodes or gives up", "cannot do the scene"};

constexpr double kCellWide = 46, kCellHigh = 24, kPanelLeft = 52, kPanelTop = 26, kPanelGap = 18, kHead = 74,
                 kFoot = 50;
constexpr int kPanelsAcross = 3;

std::string number(double value) {
  if (!(std::abs(value) < 1e4)) return "-";  // how far beyond says nothing any more
  char text[32];
  std::snprintf(text, sizeof text, value != 0 && std::abs(value) < 1e-3 ? "%.0e" : "%.2g", value);
  return text;
}

std::string column_name(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void draw_panel(Canvas& canvas, const FailureMap& map, std::size_t engine, double x, double y) {
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
    canvas.text(column_name(map.columns[c]), x + kPanelLeft + kCellWide * (double(c) + 0.5),
                y + kPanelTop + kCellHigh * double(map.steps.size()) + 13, 11, 0.5);
}

}  // namespace

convert::Error draw_map(const FailureMap& map, const std::string& file) {
  const double wide = kPanelLeft + kCellWide * double(map.columns.size()) + kPanelGap;
  const double high = kPanelTop + kCellHigh * double(map.steps.size()) + 20 + kPanelGap;
  const int down = (static_cast<int>(map.engines.size()) + kPanelsAcross - 1) / kPanelsAcross;
  const double width = kPanelGap + wide * kPanelsAcross, height = kHead + high * down + kFoot;
  Canvas canvas(file, width, height);
  canvas.text(map.title, kPanelGap, 28, 18, 0, true);
  canvas.text("down: time step; across: " + map.across + "; number: change of energy " + map.change,
              kPanelGap, 48, 12);
  for (std::size_t e = 0; e < map.engines.size(); ++e) {
    const std::size_t row = e / kPanelsAcross, column = e % kPanelsAcross;
    draw_panel(canvas, map, e, kPanelGap + wide * double(column), kHead - 12 + high * double(row));
  }
  double x = kPanelGap;
  for (int fate = 0; fate < 5; ++fate) {
    canvas.fill(kColours[fate], x, height - 34, 16, 16);
    canvas.text(kMeanings[fate], x + 22, height - 21, 12);
    x += 178;
  }
  return canvas.finish();
}

}  // namespace sinew::study
