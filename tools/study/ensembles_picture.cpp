// Mean energies of many falls as curves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
constexpr double kLeft = 64, kTop = 62, kWide = 470, kHigh = 300, kFoot = 48, kRow = 19, kSmallRow = 13,
                 kText = 11, kSmall = 10;

/// Where a moment and an energy lie on the sheet.
struct Axes {
  double seconds = 0, joules = 100;
  double x(double t) const { return kLeft + kWide * t / seconds; }
  double y(double e) const { return kTop + kHigh * (1 - std::min(e / joules, 1.0)); }
};

void draw_grid(Canvas& canvas, const Axes& axes) {
  const double step = axes.joules > 1000 ? 500 : axes.joules > 400 ? 200 : 50;
  for (double e = 0; e <= axes.joules; e += step) {
    canvas.fill(kGrid, kLeft, axes.y(e), kWide, 1);
    canvas.text(fmt::format("{:.0f} J", e), kLeft - 6, axes.y(e) + 4, kText, 1);
  }
  for (double t = 0; t <= axes.seconds + 1e-9; t += 0.25)
    canvas.text(fmt::format("{:.2f} s", t), axes.x(t), kTop + kHigh + 16, kText, 0.5);
}

void draw_curve(Canvas& canvas, const Axes& axes, const std::vector<double>& t,
                const std::vector<double>& energy, const Colour& colour, bool dashed) {
  std::vector<Spot> through;
  for (std::size_t n = 0; n < t.size(); ++n) through.push_back({axes.x(t[n]), axes.y(energy[n])});
  canvas.line(colour, dashed ? 1.2 : 2, through, dashed);
}

/// Those that have a curve to show: most of their falls came to an end, and not at many times the energy.
bool shown(const Ensemble& e, const Axes& axes) {
  constexpr double kExploded = 10;  // of what the axis shows
  return !e.t.empty() && e.seeds > e.lost &&
         *std::max_element(e.energy.mean.begin(), e.energy.mean.end()) < kExploded * axes.joules;
}

/// The curves of one scene and step, and those that have none to show.
struct Sheet {
  std::string title;
  Axes axes;
  std::vector<const Ensemble*> curves, left_out;

  static constexpr const char* kHelp =
      "mean kinetic energy over the seeds; dashed: the same engine's finest steps (black: ours)";
  static constexpr const char* kLeftOut = "exploded, or gave up in most falls:";
  static std::string key(const Ensemble& e) {
    return fmt::format("{} {}, {} seeds", e.engine, e.option, e.seeds);
  }
  static std::string name(const Ensemble& e) { return e.engine + " " + e.option; }

  Sheet(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz)
      : title(fmt::format("{}: steps of 1/{:.0f} s", scene.title, hz)) {
    std::vector<const Ensemble*> run;
    for (const Ensemble& e : all)
      if (e.scene == scene.name && e.hz == hz) run.push_back(&e);
    for (const Ensemble* e : run) {
      if (e->t.empty()) continue;
      axes.seconds = std::max(axes.seconds, e->t.back());
      if (e->engine == "Sinew" || run.size() == 1)  // truth by peers may explode
        axes.joules =
            std::max(axes.joules, 1.05 * *std::max_element(e->truth.mean.begin(), e->truth.mean.end()));
    }
    for (const Ensemble* e : run) (shown(*e, axes) ? curves : left_out).push_back(e);
  }

  double width() const {
    double key_wide = left_out.empty() ? 0 : Canvas::width_of(kLeftOut, kSmall) - 24;
    for (const Ensemble* e : curves) key_wide = std::max(key_wide, Canvas::width_of(key(*e), kText));
    for (const Ensemble* e : left_out) key_wide = std::max(key_wide, Canvas::width_of(name(*e), kSmall));
    const double head = std::max(Canvas::width_of(title, 16, true), Canvas::width_of(kHelp, 12));
    return std::ceil(std::max(kLeft + kWide + 40 + key_wide, kLeft + head) + 20);
  }
  double height() const {
    const double rows =
        kRow * double(curves.size()) + (left_out.empty() ? 0 : kRow + kSmallRow * double(left_out.size()));
    return kTop + std::max(kHigh + kFoot, rows + 30);
  }

  void draw(Canvas& canvas) const {
    canvas.text(title, kLeft, 26, 16, 0, true);
    canvas.text(kHelp, kLeft, 44, 12);
    draw_grid(canvas, axes);
    double below = kTop + 12;
    for (std::size_t n = 0; n < curves.size(); ++n) {
      const Colour& colour = kColours[n % std::size(kColours)];
      draw_curve(canvas, axes, curves[n]->t, curves[n]->energy.mean, colour, false);
      canvas.fill(colour, kLeft + kWide + 16, below - 6, 18, 4);
      canvas.text(key(*curves[n]), kLeft + kWide + 40, below, kText);
      below += kRow;
    }
    for (std::size_t n = 0; n < curves.size(); ++n)
      draw_curve(canvas, axes, curves[n]->t, curves[n]->truth.mean,
                 curves[n]->engine == "Sinew" ? kOurTruth : kColours[n % std::size(kColours)], true);
    if (!left_out.empty()) canvas.text(kLeftOut, kLeft + kWide + 16, below, kSmall);
    for (const Ensemble* e : left_out) canvas.text(name(*e), kLeft + kWide + 24, below += kSmallRow, kSmall);
  }
};

}  // namespace

std::string ensembles_svg(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz) {
  const Sheet sheet(all, scene, hz);
  if (sheet.axes.seconds == 0) return {};
  Canvas canvas("", sheet.width(), sheet.height());
  sheet.draw(canvas);
  return canvas.svg();
}

convert::Error draw_ensembles(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz,
                              const std::string& file) {
  const Sheet sheet(all, scene, hz);
  if (sheet.axes.seconds == 0) return {file + ": nobody has run '" + scene.name + "'"};
  Canvas canvas(file, sheet.width(), sheet.height());
  sheet.draw(canvas);
  return canvas.finish();
}

}  // namespace sinew::study
