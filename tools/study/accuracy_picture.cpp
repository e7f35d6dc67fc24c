// Work-precision diagrams: log-log, one line per engine and option over its steps.
#include <algorithm>
#include <cmath>
#include <vector>

#include "study/accuracy_report.h"
#include "study/words.h"

namespace sinew::study {
namespace {

constexpr Colour kOurs[] = {{0.00, 0.45, 0.70}, {0.34, 0.71, 0.91}, {0.54, 0.39, 0.82}, {0.00, 0.29, 0.48},
                            {0.23, 0.63, 0.79}, {0.70, 0.62, 0.86}, {0.00, 0.36, 0.62}, {0.45, 0.28, 0.62}};
constexpr Colour kPeers[] = {{0.84, 0.37, 0.00}, {0.90, 0.62, 0.00}, {0.75, 0.31, 0.49}, {0.00, 0.62, 0.45},
                             {0.48, 0.48, 0.00}, {0.53, 0.53, 0.53}, {0.55, 0.27, 0.07}, {0.10, 0.10, 0.10},
                             {0.76, 0.09, 0.36}, {0.00, 0.41, 0.36}, {0.72, 0.53, 0.04}, {0.43, 0.30, 0.62}};
constexpr Colour kGrid{0.88, 0.89, 0.91}, kSettings{0.62, 0.66, 0.72}, kInk{0.1, 0.1, 0.12};
constexpr const char* kSettingsLabel = "default scheme, other settings";

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

void draw_axes(Canvas& canvas, const Axis& x, const Axis& y, const char* across) {
  for (double v = x.low; v < x.high * 1.001; v *= 10) {
    canvas.line(kGrid, 1, {{x.at(v), y.from}, {x.at(v), y.to}});
    canvas.text(duration(v), x.at(v), y.from + 18, 12, 0.5);
  }
  for (double v = y.low; v < y.high * 1.001; v *= 10) {
    canvas.line(kGrid, 1, {{x.from, y.at(v)}, {x.to, y.at(v)}});
    canvas.text(length(v), x.from - 8, y.at(v) + 4, 12, 1);
  }
  canvas.text(across, (x.from + x.to) / 2, y.from + 40, 13, 0.5);
}

bool swept(const AccuracyPoint& p) {
  return p.varied == "step" || p.varied == "policy";
}

/// Survivors of one line, with something to draw on a logarithmic axis.
std::vector<const AccuracyPoint*> points_of(const AccuracyResult& result, const std::string& label) {
  std::vector<const AccuracyPoint*> line;
  for (const AccuracyPoint& p : result.points)
    if ((swept(p) ? p.label() : kSettingsLabel) == label && p.survived && p.us > 0) line.push_back(&p);
  return line;
}

std::string tip(const AccuracyPoint& p) {
  std::string text = p.label();
  text += p.h > 0 ? "\nsteps of 1/" + number(1 / p.h) + " s" : "\nsteps of its choice";
  if (!swept(p)) text += ", other " + p.varied;
  if (!swept(p) || p.h == 0) text += ", tolerance " + length(p.accuracy.tolerance);
  if (p.accuracy.substeps > 1) text += ", " + std::to_string(p.accuracy.substeps) + " substeps";
  text += "\n" + length(p.error) + " off";
  if (p.degrees > 0) text += ", " + number(p.degrees) + "°";
  text += "\n" + duration(p.us) + " per 1/60 s";
  if (p.us_worst >= 0) text += "; 99 %: " + duration(p.us_p99) + ", slowest: " + duration(p.us_worst);
  if (p.instructions > 0) text += "\n" + number(p.instructions) + " instructions";
  if (p.passes > 0) text += "\n" + number(p.passes) + " solver passes per step";
  return text;
}

void draw_line(Canvas& canvas, const std::vector<const AccuracyPoint*>& line, const ChartLine& as,
               const Axis& x, const Axis& y) {
  const auto place = [&](const AccuracyPoint* p) { return Spot{x.at(p->us), y.at(shown(p->error))}; };
  canvas.group(as.label);
  if (as.label != kSettingsLabel) {
    std::vector<Spot> through;
    for (const AccuracyPoint* p : line) through.push_back(place(p));
    canvas.line(as.colour, 1.8, through);
  }
  for (const AccuracyPoint* p : line) {
    canvas.dot(as.colour, place(p), as.label == kSettingsLabel ? 2.5 : 3.5, tip(*p));
    if (p->pareto) canvas.ring(as.colour, place(p), 6.5);
  }
  canvas.group({});
}

/// Lines and axes into the rectangle that the axes span.
void draw_plot(Canvas& canvas, const AccuracyResult& result, Axis x, Axis y) {
  const std::vector<ChartLine> lines = chart_lines(result);
  for (const ChartLine& line : lines)
    for (const AccuracyPoint* p : points_of(result, line.label)) x.hold(p->us), y.hold(shown(p->error));
  x.round(), y.round();
  draw_axes(canvas, x, y, "processor time per simulated 1/60 s");
  for (const ChartLine& line : lines) draw_line(canvas, points_of(result, line.label), line, x, y);
}

}  // namespace

std::vector<ChartLine> chart_lines(const AccuracyResult& result) {
  std::vector<ChartLine> lines;
  const auto known = [&](const std::string& label) {
    return std::any_of(lines.begin(), lines.end(), [&](const ChartLine& l) { return l.label == label; });
  };
  if (!points_of(result, kSettingsLabel).empty()) lines.push_back({kSettingsLabel, kSettings});
  std::size_t ours = 0, peers = 0;
  for (const AccuracyPoint& p : result.points) {
    if (!swept(p) || known(p.label()) || points_of(result, p.label()).empty()) continue;
    const bool our = p.engine == "Sinew";
    lines.push_back(
        {p.label(), our ? kOurs[ours++ % std::size(kOurs)] : kPeers[peers++ % std::size(kPeers)]});
  }
  return lines;
}

std::string chart_svg(const AccuracyResult& result, double width, double height) {
  if (chart_lines(result).empty()) return {};
  constexpr double kLeft = 64, kTop = 12, kRight = 24, kBottom = 52;
  Canvas canvas("", width, height);
  draw_plot(canvas, result, {.from = kLeft, .to = width - kRight}, {.from = height - kBottom, .to = kTop});
  return canvas.svg();
}

convert::Error draw_accuracy(const AccuracyResult& result, const std::string& file) {
  const std::vector<ChartLine> lines = chart_lines(result);
  if (lines.empty()) return {file + ": there is no point to draw"};
  constexpr double kPlotWide = 566, kPlotHigh = 398, kLeft = 84, kTop = 64, kBottom = 58, kKey = 13,
                   kRow = 22;
  double key = 0;  // as wide as its longest name, as high as it has names
  for (const ChartLine& line : lines) key = std::max(key, Canvas::width_of(line.label, kKey));
  const double rows = kRow * double(lines.size()), right = kLeft + kPlotWide;
  const double high = kTop + std::max(kPlotHigh + kBottom, rows + 8);
  const std::string title = result.scene.title + ": error against time",
                    help =
                        "down is more accurate, left is faster; one dot per step size, ringed where nothing "
                        "beats it";
  const double wide = std::max(
      {right + 42 + key + 20, 40 + Canvas::width_of(title, 18, true), 40 + Canvas::width_of(help, 12)});
  Canvas canvas(file, std::ceil(wide), high);
  canvas.text(title, 20, 30, 18, 0, true);
  canvas.text(help, 20, 50, 12);
  draw_plot(canvas, result, {.from = kLeft, .to = right}, {.from = kTop + kPlotHigh, .to = kTop});
  double y = kTop + 12;
  for (const ChartLine& line : lines) {
    canvas.fill(line.colour, right + 24, y - 9, 11, 11);
    canvas.text(line.label, right + 42, y, kKey);
    y += kRow;
  }
  return canvas.finish();
}

std::string agreement_svg(const std::vector<EstimatedFrame>& frames, double width) {
  constexpr double kLeft = 64, kTop = 12, kRight = 24, kBottom = 52;
  const double high = 0.75 * width;
  Axis x{.from = kLeft, .to = width - kRight}, y{.from = high - kBottom, .to = kTop};
  for (const EstimatedFrame& f : frames)
    for (Axis* axis : {&x, &y}) axis->hold(f.truth), axis->hold(f.estimated);
  x.round(), y.round();
  Canvas canvas("", width, high);
  for (double v = x.low; v < x.high * 1.001; v *= 10) {
    canvas.line(kGrid, 1, {{x.at(v), y.from}, {x.at(v), y.to}});
    canvas.line(kGrid, 1, {{x.from, y.at(v)}, {x.to, y.at(v)}});
    canvas.text(length(v), x.at(v), y.from + 18, 12, 0.5);
    canvas.text(length(v), x.from - 8, y.at(v) + 4, 12, 1);
  }
  canvas.text("true error of a step (up: its own estimate)", (x.from + x.to) / 2, y.from + 40, 13, 0.5);
  canvas.line(kInk, 1, {{x.from, y.from}, {x.to, y.to}}, true);
  for (const EstimatedFrame& f : frames)
    canvas.dot(kOurs[0], {x.at(f.truth), y.at(f.estimated)}, 3.5,
               "true " + length(f.truth) + ", estimated " + length(f.estimated));
  return canvas.svg();
}

std::string summary_svg(const std::vector<SummaryRow>& rows, double width) {
  constexpr double kBar = 18, kGap = 14, kTitle = 18, kValue = 92;
  struct Bar {
    std::string engine;
    double count;
  };
  double most = 1, high = 8;
  std::vector<std::vector<Bar>> bars;
  for (const SummaryRow& row : rows) {
    std::vector<Bar>& of_row = bars.emplace_back();
    if (row.ours.survived) of_row.push_back({"Sinew", 1000 / row.ours.us});
    for (const AccuracyPoint& p : row.peers) of_row.push_back({p.engine, 1000 / p.us});
    for (const Bar& bar : of_row) most = std::max(most, bar.count);
    high += kTitle + kBar * double(std::max<std::size_t>(1, of_row.size())) + kGap;
  }
  Canvas canvas("", width, high);
  double y = 8;
  const bool several =
      std::any_of(rows.begin(), rows.end(), [](const SummaryRow& r) { return !r.peers.empty(); });
  const double left = several ? 74 : 4;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    canvas.text(rows[n].title + ", within " + length(rows[n].error), 4, y + 12, 13, 0, true);
    y += kTitle;
    if (bars[n].empty()) canvas.text("no setting that was measured gets there", left, y + 13, 12);
    for (const Bar& bar : bars[n]) {
      const double wide = std::max(1.5, (width - left - kValue) * bar.count / most);
      if (several) canvas.text(bar.engine, left - 6, y + 13, 12, 1);
      canvas.fill(bar.engine == "Sinew" ? kOurs[0] : kSettings, left, y, wide, kBar - 3);
      canvas.text(number(std::floor(bar.count)) + " per ms", left + wide + 6, y + 13, 12);
      y += kBar;
    }
    y += kGap + (bars[n].empty() ? kBar : 0);
  }
  return canvas.svg();
}

}  // namespace sinew::study
