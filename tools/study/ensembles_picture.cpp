// Mean energies of many falls as curves, by cairo.
#include <algorithm>
#include <cstdio>
#include <limits>

#include "study/canvas.h"
#include "study/ensembles.h"

namespace sinew::study {
namespace {

// Colours that stay apart for the colour-blind (after Okabe and Ito).
constexpr Colour kColours[] = {{0.00, 0.45, 0.70}, {0.84, 0.37, 0.00}, {0.00, 0.62, 0.45},
                               {0.80, 0.47, 0.65}, {0.90, 0.62, 0.00}, {0.34, 0.71, 0.91},
                               {0.40, 0.40, 0.40}, {0.60, 0.25, 0.25}};
constexpr Colour kOurTruth{0, 0, 0};
constexpr Colour kGrid{0.88, 0.88, 0.88};
constexpr double kLeft = 64, kTop = 62, kWide = 470, kHigh = 300, kLegend = 250, kFoot = 48;

/// Where a moment and an energy lie on the sheet.
struct Axes {
  double seconds, joules;
  double x(double t) const { return kLeft + kWide * t / seconds; }
  double y(double e) const { return kTop + kHigh * (1 - std::min(e / joules, 1.0)); }
};

void draw_grid(const Canvas& canvas, const Axes& axes) {
  char text[32];
  const double step = axes.joules > 1000 ? 500 : axes.joules / 5;
  for (double e = 0; e <= axes.joules; e += step) {
    canvas.fill(kGrid, kLeft, axes.y(e), kWide, 1);
    std::snprintf(text, sizeof text, "%.0f J", e);
    canvas.text(text, kLeft - 6, axes.y(e) + 4, 11, 1);
  }
  for (double t = 0; t <= axes.seconds + 1e-9; t += 0.25) {
    std::snprintf(text, sizeof text, "%.2f s", t);
    canvas.text(text, axes.x(t), kTop + kHigh + 16, 11, 0.5);
  }
}

void draw_curve(const Canvas& canvas, const Axes& axes, const std::vector<double>& t,
                const std::vector<double>& energy, const Colour& colour, bool dashed) {
  cairo_t* pen = canvas.pen();
  canvas.set(colour);
  cairo_set_line_width(pen, dashed ? 1.2 : 2);
  const double dash[] = {4, 3};
  cairo_set_dash(pen, dash, dashed ? 2 : 0, 0);
  cairo_new_path(pen);
  for (std::size_t n = 0; n < t.size(); ++n) cairo_line_to(pen, axes.x(t[n]), axes.y(energy[n]));
  cairo_stroke(pen);
  cairo_set_dash(pen, nullptr, 0, 0);
}

}  // namespace

convert::Error draw_ensembles(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz,
                              const std::string& file) {
  Axes axes{0, std::numeric_limits<double>::infinity()};
  for (const Ensemble& e : all)
    if (e.scene == scene.name && e.hz == hz && !e.t.empty()) {
      axes.seconds = std::max(axes.seconds, e.t.back());
      // The least of all engines' largest: one whose finest steps explode does not set the scale.
      axes.joules = std::min(axes.joules, 1.05 * *std::max_element(e.truth.mean.begin(), e.truth.mean.end()));
    }
  if (axes.seconds == 0) return {file + ": nobody has run '" + scene.name + "'"};
  Canvas canvas(file, kLeft + kWide + kLegend, kTop + kHigh + kFoot);
  char text[96];
  std::snprintf(text, sizeof text, "%s: steps of 1/%.0f s", scene.title.c_str(), hz);
  canvas.text(text, kLeft, 26, 16, 0, true);
  canvas.text("mean kinetic energy over the seeds; dashed: the same engine's finest steps (black: ours)",
              kLeft, 44, 12);
  draw_grid(canvas, axes);
  std::size_t index = 0;
  for (const Ensemble& e : all) {
    if (e.scene != scene.name || e.hz != hz || e.t.empty()) continue;
    const Colour& colour = kColours[index % std::size(kColours)];
    draw_curve(canvas, axes, e.t, e.energy.mean, colour, false);
    const double y = kTop + 12 + 19 * double(index);
    canvas.fill(colour, kLeft + kWide + 16, y - 6, 18, 4);
    std::snprintf(text, sizeof text, "%s %s, %d seeds", e.engine.c_str(), e.option.c_str(), e.seeds);
    canvas.text(text, kLeft + kWide + 40, y, 11);
    ++index;
  }
  index = 0;
  for (const Ensemble& e : all) {
    if (e.scene != scene.name || e.hz != hz || e.t.empty()) continue;
    const Colour& own = kColours[index++ % std::size(kColours)];
    draw_curve(canvas, axes, e.t, e.truth.mean, e.engine == "Sinew" ? kOurTruth : own, true);
  }
  return canvas.finish();
}

}  // namespace sinew::study
