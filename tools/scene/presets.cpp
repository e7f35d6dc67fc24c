#include "scene/presets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "scene/presets_data.h"

namespace sinew::scene {
namespace {

using nlohmann::json;

MeasuredAccuracy read(const json& from, const std::string& name) {
  MeasuredAccuracy m;
  m.name = name;
  m.accuracy.substeps = from.at("substeps");
  m.accuracy.tolerance = from.at("tolerance");
  m.double_precision = from.at("precision") == "double";
  m.error = from.at("error_m");
  m.degrees = from.at("error_deg");
  m.us = from.at("us");
  return m;
}

const json& data() {
  static const json parsed = json::parse(kPresetsData);
  return parsed;
}

/// A positive number and one of the units, in the unit's factor; NaN for anything else.
double quantity(const std::string& text, const std::map<std::string, double>& units, std::string& unit) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  unit = end;
  const auto found = units.find(unit);
  return found != units.end() && number > 0 && std::isfinite(number) ? number * found->second : NAN;
}

std::string figure(double value, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

}  // namespace

const std::vector<MeasuredAccuracy>& accuracy_presets() {
  static const std::vector<MeasuredAccuracy> presets = [] {
    std::vector<MeasuredAccuracy> out;
    for (const auto& [name, preset] : data().at("presets").items()) out.push_back(read(preset, name));
    return out;
  }();
  return presets;
}

const std::vector<MeasuredAccuracy>& accuracy_front() {
  static const std::vector<MeasuredAccuracy> front = [] {
    std::vector<MeasuredAccuracy> out;
    for (const json& point : data().at("front")) out.push_back(read(point, ""));
    return out;
  }();
  return front;
}

convert::Error find_preset(const std::string& name, MeasuredAccuracy& out) {
  std::string known;
  for (const MeasuredAccuracy& preset : accuracy_presets()) {
    known += (known.empty() ? "" : ", ") + preset.name;
    if (preset.name != name) continue;
    out = preset;
    return {};
  }
  return {"unknown preset '" + name + "', known are: " + known};
}

convert::Error within_error(const std::string& wanted, MeasuredAccuracy& out) {
  std::string unit;
  const double limit = quantity(wanted, {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"deg", 1}}, unit);
  if (std::isnan(limit)) return {"'" + wanted + "' is no error such as 1mm, 2cm or 2deg"};
  const auto error_of = [&](const MeasuredAccuracy& m) {
    return kDialSafety * (unit == "deg" ? m.degrees : m.error);
  };
  const MeasuredAccuracy* best = nullptr;
  double least = INFINITY;
  for (const MeasuredAccuracy& m : accuracy_front()) {
    least = std::min(least, error_of(m));
    if (error_of(m) <= limit && (!best || m.us < best->us)) best = &m;
  }
  if (!best)
    return {"no measured setting stays within " + wanted + ", the most accurate promises " +
            (unit == "deg" ? figure(least, "deg") : figure(1e3 * least, "mm"))};
  out = *best;
  return {};
}

convert::Error within_budget(const std::string& wanted, MeasuredAccuracy& out) {
  std::string unit;
  const double limit = quantity(wanted, {{"us", 1}, {"µs", 1}, {"ms", 1e3}}, unit);
  if (std::isnan(limit)) return {"'" + wanted + "' is no time such as 20us or 1ms"};
  const MeasuredAccuracy* best = nullptr;
  double least = INFINITY;
  for (const MeasuredAccuracy& m : accuracy_front()) {
    least = std::min(least, m.us);
    if (m.us <= limit && (!best || m.error < best->error)) best = &m;
  }
  if (!best)
    return {"no measured setting costs as little as " + wanted + ", the cheapest takes " +
            figure(least, "us")};
  out = *best;
  return {};
}

void set_accuracy(const MeasuredAccuracy& measured, double frame_rate, Accuracy& accuracy,
                  bool& double_precision) {
  accuracy.tolerance = measured.accuracy.tolerance;
  accuracy.substeps =
      std::max(1, static_cast<int>(std::ceil(measured.accuracy.substeps * 60 / frame_rate - 1e-9)));
  double_precision = measured.double_precision;
}

}  // namespace sinew::scene
