// What clips say beside their motion, from JSON beside the source files or in the extras of a glTF: events,
// float curves, phase markers, whether they loop; and masks of joints.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "convert/convert.h"

namespace sinew::convert {

/// Keys of a curve: (s, value), times rising.
struct CurveKeys {
  std::vector<std::pair<double, double>> keys;
  bool smooth = false;  ///< a C² curve through the keys; else straight lines, rounded at the keys
};

struct EventEntry {
  std::string name;
  double begin = 0, end = 0;  ///< s
  bool always = false;
  std::array<std::byte, 16> payload = {};
};

struct ClipEntry {
  std::optional<bool> loops;
  std::optional<bool> strengthens;  ///< false: muscles are not made as strong as it asks
  std::optional<std::vector<EventEntry>> events;
  std::map<std::string, CurveKeys> curves;
  std::vector<PhaseMarker> markers;
  int cycles = 1;
};

struct MaskEntry {
  std::vector<std::string> from, without;  ///< joints with all below them
  double weight = 1;
  int feather = 0;                       ///< joints over which the weight rises, from the first one down
  std::map<std::string, double> joints;  ///< single ones
};

struct ClipData {
  std::map<std::string, double> curves;  ///< what they are where no clip moves them
  std::map<std::string, MaskEntry> masks;
  std::map<std::string, ClipEntry> clips;

  /// Adds what `json` says; the later one counts. Faults are named with the path of keys to them.
  Error read(const nlohmann::json& json);
  /// The same of one clip, whose times begin `begin` s before it.
  Error read_clip(const std::string& name, const nlohmann::json& json, double begin = 0);

  /// Adds what another one says, which counts.
  void add(const ClipData& other);
};

/// Puts all of it into an asset whose skeleton and clips are there. A fault names clip and item: events
/// outside the clip, keys of a curve out of order, joints that do not exist. What is said of clips that do
/// not exist is an error unless `may_miss` (the user has asked for a few clips).
Error add_clip_data(const ClipData& data, bool may_miss, Asset& asset, nlohmann::json& report);

/// The clip's curve through keys: of the coarsest knots that come as close to all keys and all lines between
/// them as a five-hundredth of their range, at least three milliseconds apart. Straight lines never leave
/// their range.
FloatCurve fit_curve(const CurveKeys& keys, double duration, bool loops);

}  // namespace sinew::convert
