// Added cost against instances.
#include <algorithm>
#include <array>
#include <cmath>

#include "study/canvas.h"
#include "study/effects.h"

namespace sinew::study {
namespace {

constexpr double kWidth = 1640, kHeight = 560, kLeft = 80, kTop = 70, kPlotWide = 360, kPlotHigh = 420,
                 kGap = 165;
constexpr Colour kColours[] = {{0.00, 0.45, 0.70}, {0.90, 0.62, 0.00}, {0.00, 0.62, 0.45}, {0.80, 0.40, 0.00},
                               {0.35, 0.70, 0.90}, {0.80, 0.47, 0.65}, {0.30, 0.30, 0.30}};  // Okabe and Ito

/// Logarithmic axes: 1 … 64 instances across, decades up.
struct Plot {
  double left, low, high;  ///< place; exponents of ten
  double x(int instances) const { return left + kPlotWide * std::log2(double(instances)) / 6; }
  /// What costs nothing, or saves, lies at the bottom.
  double y(double value) const {
    const double share = (std::log10(std::max(value, 1e-9)) - low) / (high - low);
    return kTop + kPlotHigh * (1 - std::max(share, 0.0));
  }
};

void draw_frame(Canvas& canvas, const Plot& plot, const char* title) {
  canvas.text(title, plot.left, kTop - 12, 14, 0, true);
  for (int decade = static_cast<int>(plot.low); decade <= plot.high; ++decade) {
    const double y = plot.y(std::pow(10, decade));
    canvas.fill({0.88, 0.88, 0.88}, plot.left, y, kPlotWide, 1);
    canvas.text("1e" + std::to_string(decade), plot.left - 6, y + 4, 11, 1);
  }
  for (const int n : {1, 8, 64}) canvas.text(std::to_string(n), plot.x(n), kTop + kPlotHigh + 18, 11, 0.5);
  canvas.text("instances", plot.left + kPlotWide / 2, kTop + kPlotHigh + 36, 12, 0.5);
}

void draw_line(Canvas& canvas, const Plot& plot, const EffectCost& cost, const std::array<double, 4>& values,
               const Colour& colour, double label_y) {
  std::vector<Spot> through;
  for (std::size_t i = 1; i < kInstances.size(); ++i)
    through.push_back({plot.x(kInstances[i]), plot.y(values[i] - values[0])});
  canvas.line(colour, 1.8, through);
  canvas.line(colour, 0.8, {{plot.x(64) + 3, through.back().y}, {plot.x(64) + 14, label_y - 4}});
  canvas.text(cost.effect, plot.x(64) + 17, label_y, 11);
}

}  // namespace

convert::Error draw_effects(const EffectStudy& study, const std::string& file) {
  const bool counted = study.step > 0;
  Canvas canvas(file, kWidth, kHeight);
  canvas.text(
      counted ? "Instructions that an effect adds to a step" : "Microseconds that an effect adds to a step",
      kLeft, 28, 18, 0, true);
  double left = kLeft;
  constexpr std::array<const char*, 3> titles{"character on its animation",
                                              "one Newton pass, or a solve of one",
                                              "whole steps of what is solved for"};
  for (std::size_t group = 0; group < titles.size(); ++group) {
    const Plot plot = counted ? Plot{left, 1, 8} : Plot{left, -3, 3};
    draw_frame(canvas, plot, titles[group]);
    std::vector<std::pair<double, const EffectCost*>> ends;  // from the top
    for (const EffectCost& c : study.costs) {
      if ((c.mode == "checked" ? 0u : c.mode == "step" ? 2u : 1u) != group || c.instance.empty()) continue;
      const auto& values = counted ? c.instructions : c.microseconds;
      ends.emplace_back(plot.y(values[3] - values[0]), &c);
    }
    std::sort(ends.begin(), ends.end());
    double label = 0;
    for (std::size_t n = 0; n < ends.size(); ++n) {
      label = std::max(label + 15, ends[n].first + 4);
      const EffectCost& c = *ends[n].second;
      draw_line(canvas, plot, c, counted ? c.instructions : c.microseconds, kColours[n % std::size(kColours)],
                label);
    }
    left += kPlotWide + kGap;
  }
  return canvas.finish();
}

}  // namespace sinew::study
