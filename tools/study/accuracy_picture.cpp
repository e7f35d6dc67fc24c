// A work-precision diagram on paper: log-log, one line per engine and option over its steps.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "study/accuracy.h"
#include "study/canvas.h"

namespace sinew::study {
namespace {

constexpr double kWide = 860, kHigh = 520, kLeft = 84, kTop = 64, kRight = 210, kBottom = 58;
constexpr Colour kOurs[] = {{0.00, 0.45, 0.70}, {0.34, 0.71, 0.91}, {0.54, 0.39, 0.82},
                            {0.00, 0.29, 0.48}, {0.23, 0.63, 0.79}, {0.70, 0.62, 0.86}};
constexpr Colour kPeers[] = {{0.84, 0.37, 0.00}, {0.90, 0.62, 0.00}, {0.75, 0.31, 0.49}, {0.00, 0.62, 0.45},
                             {0.48, 0.48, 0.00}, {0.53, 0.53, 0.53}, {0.55, 0.27, 0.07}, {0.10, 0.10, 0.10},
                             {0.76, 0.09, 0.36}, {0.00, 0.41, 0.36}, {0.72, 0.53, 0.04}, {0.43, 0.30, 0.62}};

/// m; below a nanometre every error is drawn alike.
double shown(double error) {
  return std::max(error, 1e-9);
}

/// A logarithmic axis from `low` to `high`, drawn from pixel `from` to `to`.
struct Axis {
  double low = 1e300, high = 0, from, to;
  void hold(double value) { low = std::min(low, value), high = std::max(high, value); }
  void round() {
    low = std::pow(10, std::floor(std::log10(low)));
    high = std::max(10 * low, std::pow(10, std::ceil(std::log10(high))));
  }
  double at(double value) const { return from + (to - from) * std::log(value / low) / std::log(high / low); }
};

std::string length(double metres) {
  char text[32];
  if (metres >= 0.999)
    std::snprintf(text, sizeof text, "%.0f m", metres);
  else if (metres >= 0.999e-3)
    std::snprintf(text, sizeof text, "%.0f mm", 1e3 * metres);
  else if (metres >= 0.999e-6)
    std::snprintf(text, sizeof text, "%.0f µm", 1e6 * metres);
  else
    std::snprintf(text, sizeof text, "%.0f nm", 1e9 * metres);
  return text;
}

void draw_axes(const Canvas& canvas, const Axis& x, const Axis& y) {
  cairo_t* pen = canvas.pen();
  cairo_set_line_width(pen, 1);
  const auto line = [&](double x0, double y0, double x1, double y1) {
    canvas.set({0.88, 0.89, 0.91});
    cairo_move_to(pen, x0, y0);
    cairo_line_to(pen, x1, y1);
    cairo_stroke(pen);
  };
  char text[32];
  for (double v = x.low; v < x.high * 1.001; v *= 10) {
    line(x.at(v), y.from, x.at(v), y.to);
    std::snprintf(text, sizeof text, "%g µs", v);
    canvas.text(text, x.at(v), y.from + 18, 12, 0.5);
  }
  for (double v = y.low; v < y.high * 1.001; v *= 10) {
    line(x.from, y.at(v), x.to, y.at(v));
    canvas.text(length(v), x.from - 8, y.at(v) + 4, 12, 1);
  }
  canvas.text("processor time per simulated 1/60 s", (x.from + x.to) / 2, y.from + 42, 13, 0.5);
}

/// Survivors of one option's sweep over steps, with something to draw on a logarithmic axis.
std::vector<const AccuracyPoint*> sweep_of(const AccuracyResult& result, const std::string& label) {
  std::vector<const AccuracyPoint*> line;
  for (const AccuracyPoint& p : result.points)
    if (p.label() == label && (p.varied == "step" || p.varied == "policy") && p.survived && p.us > 0)
      line.push_back(&p);
  return line;
}

void draw_line(const Canvas& canvas, const std::vector<const AccuracyPoint*>& line, const Colour& colour,
               const Axis& x, const Axis& y) {
  cairo_t* pen = canvas.pen();
  canvas.set(colour);
  cairo_set_line_width(pen, 1.8);
  cairo_new_path(pen);
  for (const AccuracyPoint* p : line) cairo_line_to(pen, x.at(p->us), y.at(shown(p->error)));
  cairo_stroke(pen);
  for (const AccuracyPoint* p : line) {
    cairo_new_path(pen);
    cairo_arc(pen, x.at(p->us), y.at(shown(p->error)), 3.5, 0, 7);
    cairo_fill(pen);
    if (!p->pareto) continue;
    cairo_arc(pen, x.at(p->us), y.at(shown(p->error)), 6.5, 0, 7);
    cairo_stroke(pen);
  }
}

}  // namespace

convert::Error draw_accuracy(const AccuracyResult& result, const std::string& file) {
  std::vector<std::string> labels;
  Axis x{.from = kLeft, .to = kWide - kRight}, y{.from = kHigh - kBottom, .to = kTop};
  for (const AccuracyPoint& p : result.points)
    if (std::find(labels.begin(), labels.end(), p.label()) == labels.end()) labels.push_back(p.label());
  for (const std::string& label : labels)
    for (const AccuracyPoint* p : sweep_of(result, label)) x.hold(p->us), y.hold(shown(p->error));
  std::erase_if(labels, [&](const std::string& label) { return sweep_of(result, label).empty(); });
  if (labels.empty()) return {file + ": there is no point to draw"};
  x.round(), y.round();
  Canvas canvas(file, kWide, kHigh);
  canvas.text(result.scene.title + ": error against time", 20, 30, 18, 0, true);
  canvas.text("down is more accurate, left is faster; one dot per step size, ringed where nothing beats it",
              20, 50, 12);
  draw_axes(canvas, x, y);
  std::size_t ours = 0, peers = 0;
  double key = kTop + 12;
  for (const std::string& label : labels) {
    const bool our = label.starts_with("Sinew");
    const Colour& colour = our ? kOurs[ours++ % std::size(kOurs)] : kPeers[peers++ % std::size(kPeers)];
    draw_line(canvas, sweep_of(result, label), colour, x, y);
    canvas.fill(colour, kWide - kRight + 24, key - 9, 11, 11);
    canvas.text(label, kWide - kRight + 42, key, 13);
    key += 22;
  }
  return canvas.finish();
}

}  // namespace sinew::study
