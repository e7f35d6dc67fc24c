#include "export/clip_extras.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sinew/animation/curve_job.h"

namespace sinew::exporting {
namespace {

using nlohmann::json;

std::string name_of(const Asset& asset, std::uint32_t number) {
  for (const std::string& name : asset.event_names)
    if (event_name(name) == number) return name;
  return {};
}

json event(const Asset& asset, const ClipEvent& e) {
  json out = {{"name", name_of(asset, e.name)}};
  if (e.end > e.begin)
    out.update({{"from", e.begin}, {"to", e.end}});
  else
    out["time"] = e.begin;
  if (e.always) out["always"] = true;
  std::size_t length = e.payload.size();
  while (length > 0 && e.payload[length - 1] == std::byte{0}) --length;
  if (length == 0) return out;
  std::string text;
  json bytes = json::array();
  bool printable = true;
  for (std::size_t k = 0; k < length; ++k) {
    const int byte = std::to_integer<int>(e.payload[k]);
    printable = printable && byte >= 32 && byte < 127;
    text += static_cast<char>(byte);
    bytes.push_back(byte);
  }
  out["payload"] = printable ? json(text) : bytes;
  return out;
}

/// A curve's values at its knots.
json curve(const Asset& asset, const Clip& clip, const FloatCurve& curve) {
  json keys = json::array();
  std::vector<TimeJet<double>> values(asset.curve_slots.size());
  const auto knots = std::max(1L, std::lround(double(clip.duration) / double(curve.knot_interval)));
  for (long k = 0; k < knots + (clip.loops ? 0 : 1); ++k) {
    CurveJob<double> job;
    job.clip = &clip;
    job.time = double(clip.duration) * double(k) / double(knots);
    job.slots = asset.curve_slots;
    job.values = values;
    (void)job.Run();  // clip and slots are valid: the asset is
    keys.push_back({job.time.value, values[static_cast<std::size_t>(curve.slot)].value});
  }
  return {{"keys", keys}, {"smooth", true}};
}

}  // namespace

json clip_extras(const Asset& asset, const Clip& clip) {
  json own = {{"loops", clip.loops}};
  for (const ClipEvent& e : clip.events)
    if (!name_of(asset, e.name).empty()) own["events"].push_back(event(asset, e));
  for (const FloatCurve& c : clip.curves)
    own["curves"][asset.curve_slots[static_cast<std::size_t>(c.slot)].name] = curve(asset, clip, c);
  for (const PhaseMarker& m : clip.markers) own["markers"].push_back({{"phase", m.phase}, {"time", m.time}});
  if (!clip.markers.empty()) own["cycles"] = clip.cycles;
  json out = {{"sinew", own}};
  for (const ContactWindow& w : clip.contacts)
    out["contacts"].push_back({{"joint", asset.skeleton.joints[static_cast<std::size_t>(w.joint)].name},
                               {"from", w.begin},
                               {"to", w.end}});
  return out;
}

json asset_extras(const Asset& asset) {
  json own;
  for (const CurveSlot& slot : asset.curve_slots) own["curves"][slot.name] = slot.rest;
  for (const JointMask& mask : asset.masks) {
    json weights = json::object();
    for (std::size_t j = 0; j < mask.weights.size(); ++j)
      if (mask.weights[j] > 0) weights[asset.skeleton.joints[j].name] = mask.weights[j] / 255.0;
    if (!weights.empty()) own["masks"][mask.name] = {{"joints", weights}};
  }
  return own.is_null() ? own : json{{"sinew", own}};
}

}  // namespace sinew::exporting
