#include "study/accuracy_dial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "study/accuracy_trip.h"
#include "study/words.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;  // s

/// A preset is the cheapest setting within its error (m); the strictest stand last.
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

/// µs of frames.
FrameCosts timed(const AccuracyScene& scene, const DialPoint& p, int runs) {
  std::vector<std::vector<double>> times;
  for (int n = 0; n < runs; ++n) times.push_back(travel(scene, p.option, kFrame, p.accuracy, false).frames);
  const FrameCosts costs = frame_costs(times);
  return {1e6 * costs.mean, 1e6 * costs.p99, 1e6 * costs.worst};
}

nlohmann::json as_json(const DialPoint& p) {
  return {{"substeps", p.accuracy.substeps},
          {"tolerance", p.accuracy.tolerance},
          {"precision", p.precise() ? "double" : "float"},
          {"error_m", p.error},
          {"error_deg", p.degrees},
          {"us", p.us},
          {"us_p99", p.us_p99},
          {"us_worst", p.us_worst},
          {"us_limp", p.us_limp},
          {"us_limp_p99", p.us_limp_p99},
          {"us_limp_worst", p.us_limp_worst}};
}

/// The cheapest while limp is the cheapest when it matters; where none is that accurate, the most accurate.
const DialPoint* chosen(const std::vector<DialPoint>& front, double error) {
  const DialPoint* best = nullptr;
  for (const DialPoint& p : front) {
    const bool within = p.error <= error, was = best && best->error <= error;
    if (!best || (within && (!was || p.us_limp < best->us_limp)) ||
        (!within && !was && p.error < best->error))
      best = &p;
  }
  return best;
}

/// "crowd" → "kCrowdPreset"
std::string constant(std::string name) {
  name[0] = static_cast<char>(std::toupper(name[0]));
  return "k" + name + "Preset";
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
      if (scene.name == "tracking") {
        const FrameCosts costs = timed(scene, p, runs);
        p.us = costs.mean, p.us_p99 = costs.p99, p.us_worst = costs.worst;
      }
      if (scene.name == "collapse") {
        const FrameCosts costs = timed(scene, p, std::max(3, runs / 3));
        p.us_limp = costs.mean, p.us_limp_p99 = costs.p99, p.us_limp_worst = costs.worst;
      }
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
  for (std::size_t n = 0; n < std::size(kRules) && !front.empty(); ++n) {
    const Rule& rule = kRules[n];
    const DialPoint* best = chosen(front, rule.error);
    presets[rule.name] = as_json(*best);
    presets[rule.name]["wanted_m"] = rule.error;
    presets[rule.name]["for"] = rule.meant_for;
    if (n + 1 < std::size(kRules) && chosen(front, kRules[n + 1].error) == best)
      presets[rule.name]["same_as"] = kRules[n + 1].name;
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
  for (std::size_t n = std::size(kRules); n-- > 0;) {  // who is the same as another stands after it
    const std::string name = kRules[n].name;
    if (!dial["presets"].contains(name)) continue;
    const nlohmann::json& p = dial["presets"][name];
    const std::string meant_for = p["for"];
    if (p.contains("same_as")) {
      const std::string other = constant(p["same_as"]);
      text += fmt::format(
          "/// For {}. No cheaper setting was measured: another name of {}.\n"
          "inline constexpr AccuracyPreset {} = {};\n",
          meant_for, other, constant(name), other);
      continue;
    }
    text += fmt::format(
        "/// For {}. Within {} of a converged run; {:.0f} µs per 1/60 s\n"
        "/// while pushed, {:.0f} µs while collapsing.\n"
        "inline constexpr AccuracyPreset {}{{\n"
        "    \"{}\", {}, {{.tolerance = {:g}, .substeps = {}}}, {:.2g}}};\n",
        meant_for, length(p["error_m"]), p["us"].get<double>(), p["us_limp"].get<double>(), constant(name),
        name, p["precision"] == "double", p["tolerance"].get<double>(), p["substeps"].get<int>(),
        p["error_m"].get<double>());
  }
  return text + "\n}  // namespace sinew\n";
}

convert::Error store_presets(
    const nlohmann::json& dial, const std::string& directory, const MachineCheck& machine,
    const std::function<convert::Error(const std::string&, const std::string&)>& write) {
  if (machine.busy())
    return {"no presets are written, since the machine was busy: " + machine.reason() +
            "; run the study again when nothing else runs"};
  if (convert::Error error = write(directory + "/accuracy_presets.json", dial.dump(1) + "\n")) return error;
  return write(directory + "/presets.h", dial_header(dial));
}

}  // namespace sinew::study
