// Mean energies of many falls as curves, by cairo.
#include <algorithm>
#include <cstdio>
#include <functional>

#include "study/canvas.h"
#include "study/ensembles.h"

namespace sinew::study {
namespace {

// Colours that stay apart for the colour-blind (after Okabe and Ito).
constexpr Colour kColours[] = {{0.00, 0.45, 0.70}, {0.84, 0.37, 0.00}, {0.00, 0.62, 0.45},
                               {0.80, 0.47, 0.65}, {0.90, 0.62, 0.00}, {0.34, 0.71, 0.91},
                               {0.40, 0.40, 0.40}, {0.60, 0.25, 0.25}, {0.55, 0.75, 0.25}};
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
  const double step = axes.joules > 1000 ? 500 : axes.joules > 400 ? 200 : 50;
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

/// Those that have a curve to show: most of their falls came to an end, and not at many times the energy.
bool shown(const Ensemble& e, const Axes& axes) {
  constexpr double kExploded = 10;  // of what the axis shows
  return !e.t.empty() && e.seeds > e.lost &&
         *std::max_element(e.energy.mean.begin(), e.energy.mean.end()) < kExploded * axes.joules;
}

}  // namespace

convert::Error draw_ensembles(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz,
                              const std::string& file) {
  std::vector<const Ensemble*> run;
  for (const Ensemble& e : all)
    if (e.scene == scene.name && e.hz == hz) run.push_back(&e);
  Axes axes{0, 100};
  for (const Ensemble* e : run) {
    if (e->t.empty()) continue;
    axes.seconds = std::max(axes.seconds, e->t.back());
    if (e->engine == "Sinew" || run.size() == 1)  // truth by peers may explode
      axes.joules =
          std::max(axes.joules, 1.05 * *std::max_element(e->truth.mean.begin(), e->truth.mean.end()));
  }
  if (axes.seconds == 0) return {file + ": nobody has run '" + scene.name + "'"};
  Canvas canvas(file, kLeft + kWide + kLegend, kTop + kHigh + kFoot);
  char text[96];
  std::snprintf(text, sizeof text, "%s: steps of 1/%.0f s", scene.title.c_str(), hz);
  canvas.text(text, kLeft, 26, 16, 0, true);
  canvas.text("mean kinetic energy over the seeds; dashed: the same engine's finest steps (black: ours)",
              kLeft, 44, 12);
  draw_grid(canvas, axes);
  const auto hidden = [&](const Ensemble* e) { return !shown(*e, axes); };
  const auto left_out = std::stable_partition(run.begin(), run.end(), std::not_fn(hidden));
  double below = kTop + 26 + 19 * double(left_out - run.begin());
  if (left_out != run.end())
    canvas.text("exploded, or gave up in most falls:", kLeft + kWide + 16, below, 10);
  for (auto e = left_out; e != run.end(); ++e)
    canvas.text((*e)->engine + " " + (*e)->option, kLeft + kWide + 24, below += 13, 10);
  run.erase(left_out, run.end());
  for (std::size_t n = 0; n < run.size(); ++n) {
    const Ensemble& e = *run[n];
    const Colour& colour = kColours[n % std::size(kColours)];
    draw_curve(canvas, axes, e.t, e.energy.mean, colour, false);
    const double y = kTop + 12 + 19 * double(n);
    canvas.fill(colour, kLeft + kWide + 16, y - 6, 18, 4);
    std::snprintf(text, sizeof text, "%s %s, %d seeds", e.engine.c_str(), e.option.c_str(), e.seeds);
    canvas.text(text, kLeft + kWide + 40, y, 11);
  }
  for (std::size_t n = 0; n < run.size(); ++n) {
    const Colour& own = kColours[n % std::size(kColours)];
    draw_curve(canvas, axes, run[n]->t, run[n]->truth.mean, run[n]->engine == "Sinew" ? kOurTruth : own,
               true);
  }
  return canvas.finish();
}

}  // namespace sinew::study
