#include "study/accuracy_dial.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/presets.h"
#include "study/accuracy_trip.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;  // s

/// A preset is the cheapest setting within its error (m).
struct Rule {
  const char* name;
  double error;
  const char* meant_for;
};
constexpr Rule kRules[] = {{"crowd", 0.2, "many characters, seen from afar"},
                           {"game", 0.1, "players and those near them"},
                           {"cinematic", 0.002, "close-ups, recorded takes"},
                           {"reference", 0.0005, "comparing others with"}};

EngineOption option_named(const std::string& name) {
  const std::vector<EngineOption> all = sinew_options();
  return *std::find_if(all.begin(), all.end(), [&](const EngineOption& o) { return o.option == name; });
}

std::vector<DialPoint> candidates(bool quick) {
  std::vector<DialPoint> out;
  const std::vector<int> substeps =
      quick ? std::vector{1, 4} : std::vector{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48};
  for (const char* option : {"bossak float", "bossak double"})
    for (const int parts : substeps)
      for (const double tolerance : {3e-4, 3e-5, 1e-6, 1e-7}) {
        if (quick && tolerance != 3e-5) continue;
        if (tolerance < 1e-5 && std::string(option).find("float") != std::string::npos) continue;
        DialPoint& p = out.emplace_back();
        p.option = option_named(option);
        p.accuracy.substeps = parts;
        p.accuracy.tolerance = tolerance;
      }
  return out;
}

double median_us(const AccuracyScene& scene, const DialPoint& p, int runs) {
  std::vector<double> times;
  for (int n = 0; n < runs; ++n) times.push_back(travel(scene, p.option, kFrame, p.accuracy, false).seconds);
  std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
  return 1e6 * times[runs / 2] * kFrame / scene.seconds;
}

nlohmann::json as_json(const DialPoint& p) {
  return {{"substeps", p.accuracy.substeps},
          {"tolerance", p.accuracy.tolerance},
          {"precision", p.precise() ? "double" : "float"},
          {"error_m", p.error},
          {"error_deg", p.degrees},
          {"us", p.us},
          {"us_limp", p.us_limp}};
}

}  // namespace

std::vector<std::string> dial_scenes() {
  return {"tumbling", "pendulum", "collapse", "stack", "tracking", "running"};
}

std::vector<DialPoint> measure_dial(bool quick, const std::function<void(int, int)>& progress) {
  std::vector<DialPoint> points = candidates(quick);
  const int runs = quick ? 3 : 21, total = static_cast<int>(points.size() * dial_scenes().size());
  int done = 0;
  for (const AccuracyScene& scene : accuracy_scenes()) {
    const std::vector<std::string> counted = dial_scenes();
    if (scene.scene.figures.empty() || std::find(counted.begin(), counted.end(), scene.name) == counted.end())
      continue;
    const Track truth = converged(scene, option_named("bossak double"), quick);
    for (DialPoint& p : points) {
      const Trip trip = travel(scene, p.option, kFrame, p.accuracy, true);
      const double error = trip.survived ? apart(scene, trip.track, truth) : INFINITY;
      p.error = std::isfinite(error) ? std::max(p.error, error) : INFINITY;
      if (scene.drive) p.degrees = std::max(p.degrees, degrees_apart(scene, trip.track, truth));
      if (scene.name == "tracking") p.us = median_us(scene, p, runs);
      if (scene.name == "collapse") p.us_limp = median_us(scene, p, std::max(3, runs / 3));
      if (progress) progress(++done, total);
    }
  }
  return points;
}

std::vector<DialPoint> dial_front(std::vector<DialPoint> points) {
  const auto beaten = [&](const DialPoint& p) {
    return !std::isfinite(p.error) || std::any_of(points.begin(), points.end(), [&](const DialPoint& o) {
      const bool no_worse =
          o.us <= p.us && o.us_limp <= p.us_limp && o.error <= p.error && o.degrees <= p.degrees;
      return no_worse && (o.us < p.us || o.us_limp < p.us_limp || o.error < p.error || o.degrees < p.degrees);
    });
  };
  std::vector<DialPoint> front;
  for (const DialPoint& p : points)
    if (!beaten(p)) front.push_back(p);
  std::sort(front.begin(), front.end(), [](const DialPoint& a, const DialPoint& b) { return a.us < b.us; });
  return front;
}

nlohmann::json dial_json(const std::vector<DialPoint>& front, const std::string& machine,
                         const std::string& date) {
  nlohmann::json points = nlohmann::json::array(), presets = nlohmann::json::object();
  for (const DialPoint& p : front) points.push_back(as_json(p));
  for (const Rule& rule : kRules) {
    // The cheapest while limp is the cheapest when it matters; where none is that accurate, the most
    // accurate.
    const DialPoint* best = nullptr;
    for (const DialPoint& p : front) {
      const bool within = p.error <= rule.error, was = best && best->error <= rule.error;
      if (!best || (within && (!was || p.us_limp < best->us_limp)) ||
          (!within && !was && p.error < best->error))
        best = &p;
    }
    if (!best) continue;
    presets[rule.name] = as_json(*best);
    presets[rule.name]["wanted_m"] = rule.error;
    presets[rule.name]["for"] = rule.meant_for;
  }
  return {{"made_by", "sinew study accuracy"}, {"date", date},    {"machine", machine},
          {"scenes", dial_scenes()},           {"front", points}, {"presets", presets}};
}

std::string dial_header(const nlohmann::json& dial) {
  std::string text =
      "// Accuracy presets, chosen from measured curves: written by `sinew study accuracy` (DIR/presets.h), "
      "not by\n"
      "// hand. The same figures, with where and when they were measured, are in "
      "assets/accuracy_presets.json.\n"
      "#pragma once\n\n#include \"sinew/optimizer/accuracy.h\"\n\nnamespace sinew {\n\n"
      "struct AccuracyPreset {\n"
      "  const char* name;\n"
      "  bool double_precision;  ///< World<double>, else World<float>\n"
      "  Accuracy accuracy;      ///< substeps are those of a step of 1/60 s\n"
      "  double error;           ///< m, the largest measured: rms of all mass from a converged run\n"
      "};\n\n";
  for (const auto& [name, p] : dial["presets"].items()) {
    char line[400];
    std::snprintf(line, sizeof line,
                  "/// For %s. Within %.2g m of a converged run; %.0f µs per 1/60 s\n"
                  "/// while pushed, %.0f µs while collapsing.\n"
                  "inline constexpr AccuracyPreset k%c%sPreset{\n"
                  "    \"%s\", %s, {.tolerance = %g, .substeps = %d}, %.2g};\n",
                  p["for"].get<std::string>().c_str(), p["error_m"].get<double>(), p["us"].get<double>(),
                  p["us_limp"].get<double>(), std::toupper(name[0]), name.c_str() + 1, name.c_str(),
                  p["precision"] == "double" ? "true" : "false", p["tolerance"].get<double>(),
                  p["substeps"].get<int>(), p["error_m"].get<double>());
    text += line;
  }
  return text + "\n}  // namespace sinew\n";
}

}  // namespace sinew::study
