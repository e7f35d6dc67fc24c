#include "scene/graph_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/run.h"
#include "study/canvas.h"

namespace sinew::scene {
namespace {

using study::Canvas;
using study::Colour;
using study::Spot;

constexpr Colour kOwn{0.13, 0.45, 0.70}, kUsual{0.85, 0.37, 0.10}, kGrid{0.87, 0.87, 0.87};
constexpr double kWide = 960, kHigh = 250, kLeft = 70, kRight = 20, kTop = 64, kGap = 46;

/// One panel of the sheet: time across, a quantity up from 0 to a round number.
struct Panel {
  double top, seconds, most;

  double x(double t) const { return kLeft + (kWide - kLeft - kRight) * t / seconds; }
  double y(double v) const { return top + kHigh * (1 - std::min(v, most) / most); }
};

double round_up(double v) {
  const double scale = std::pow(10, std::floor(std::log10(std::max(v, 1e-3))));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 8.0, 10.0})
    if (v <= step * scale) return step * scale;
  return v;
}

void axes(Canvas& canvas, const Panel& p, const std::string& what) {
  canvas.text(what, kLeft, p.top - 8, 12, 0, true);
  for (int k = 0; k <= 4; ++k) {
    const double v = p.most * k / 4;
    canvas.line(kGrid, 1, {{kLeft, p.y(v)}, {kWide - kRight, p.y(v)}});
    canvas.text(fmt::format("{:g}", v), kLeft - 6, p.y(v) + 4, 11, 1);
  }
  for (int t = 0; t <= static_cast<int>(p.seconds); ++t)
    canvas.text(std::to_string(t), p.x(t), p.top + kHigh + 15, 11, 0.5);
}

void curve(Canvas& canvas, const Panel& p, const Colour& colour, const std::vector<double>& time,
           const std::vector<double>& values) {
  std::vector<Spot> spots;
  for (std::size_t k = 0; k < time.size(); ++k) spots.push_back({p.x(time[k]), p.y(values[k])});
  canvas.line(colour, 1.3, spots);
}

double most_of(const std::vector<double>& v) {
  return v.empty() ? 0 : *std::max_element(v.begin(), v.end());
}

}  // namespace

convert::Error with_smoothsteps(const Scene& scene, Scene& out) {
  out = scene;
  for (SceneCharacter& c : out.characters) {
    if (!c.graph.graph) continue;
    GraphDefinition definition = c.graph.graph->definition();
    for (GraphNode& node : definition.nodes)
      for (GraphTransition& t : node.transitions) {
        if (t.kind == TransitionKind::kCut) continue;
        t.kind = TransitionKind::kSmoothstep;
        t.budget = 0;
      }
    auto graph = std::make_shared<Graph>();
    if (const Status status = Graph::bind(definition, *c.asset, *graph); !status) return {status.reason};
    c.graph.graph = std::move(graph);
  }
  return {};
}

convert::Error run_asked(const Scene& scene, AskedOf& out) {
  if (scene.characters.empty() || !scene.characters[0].graph.graph)
    return {"the scene's first character plays no graph"};
  Recording recording;
  Telemetry telemetry;
  if (convert::Error error = run_scene(scene, recording, telemetry, {})) return error;
  for (const TelemetryRow& row : telemetry.rows) {
    if (row.character != 0) continue;
    out.time.push_back(row.time);
    out.acceleration.push_back(row.asked);
    out.load.push_back(row.load);
  }
  return {};
}

std::string summary_of(const AskedOf& asked) {
  std::vector<double> sorted = asked.acceleration;
  if (sorted.empty()) return "no frames";
  std::sort(sorted.begin(), sorted.end());
  const auto full =
      std::count_if(asked.load.begin(), asked.load.end(), [](double load) { return load > 0.999; });
  return fmt::format(
      "greatest |q''| {:.0f} rad/s², 95 % of the frames below {:.0f}; a muscle at its limit in {:.0f} % of "
      "them",
      sorted.back(), sorted[sorted.size() * 95 / 100], 100.0 * double(full) / double(sorted.size()));
}

convert::Error plot_asked(const Scene& scene, const AskedOf& own, const AskedOf& usual,
                          const std::string& path) {
  Canvas canvas(path, kWide, kTop + 2 * kHigh + kGap + 40);
  canvas.text(scene.title, kLeft, 22, 16, 0, true);
  canvas.line(kOwn, 2.5, {{kLeft + 300, 18}, {kLeft + 330, 18}});
  canvas.text("the graph", kLeft + 336, 22, 12);
  canvas.line(kUsual, 2.5, {{kLeft + 430, 18}, {kLeft + 460, 18}});
  canvas.text("the same with smoothstep crossfades", kLeft + 466, 22, 12);
  const double seconds = std::max(1e-3, scene.duration);
  const Panel top{kTop, seconds, round_up(std::max(most_of(own.acceleration), most_of(usual.acceleration)))},
      bottom{kTop + kHigh + kGap, seconds, round_up(std::max(most_of(own.load), most_of(usual.load)))};
  axes(canvas, top, "greatest |q''| that is asked of a joint, rad/s²");
  axes(canvas, bottom, "greatest load of a muscle, of its limit");
  for (const auto& [t, text] : scene.captions)
    canvas.line(kGrid, 1, {{top.x(t), top.y(top.most)}, {top.x(t), bottom.y(0)}}, true);
  curve(canvas, top, kUsual, usual.time, usual.acceleration);
  curve(canvas, top, kOwn, own.time, own.acceleration);
  curve(canvas, bottom, kUsual, usual.time, usual.load);
  curve(canvas, bottom, kOwn, own.time, own.load);
  canvas.text("time, s", kWide - kRight, bottom.top + kHigh + 32, 11, 1);
  return canvas.finish();
}

}  // namespace sinew::scene
