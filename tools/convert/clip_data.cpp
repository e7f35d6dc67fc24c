#include "convert/clip_data.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>

#include "convert/roles.h"
#include "sinew/animation/bspline.h"
#include "sinew/animation/phase_map.h"

namespace sinew::convert {
namespace {

using Json = nlohmann::json;

constexpr double kShortestKnot = 1.0 / 320;  ///< s
constexpr double kCloseness = 2e-3;          ///< of a curve's range
constexpr double kRounding = 1e-3;           ///< s, that times may be beyond a clip's ends
constexpr int kBetween = 4;                  ///< places between two knots at which a fit is judged

struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

double number(const Json& json, const std::string& where) {
  if (!json.is_number() || !(std::abs(json.get<double>()) <= 1e6))
    throw Fault(where + " is not a number below a million");
  return json.get<double>();
}

bool truth(const Json& json, const std::string& where) {
  if (!json.is_boolean()) throw Fault(where + " is neither true nor false");
  return json.get<bool>();
}

std::string text(const Json& json, const std::string& where) {
  if (!json.is_string() || json.get<std::string>().empty()) throw Fault(where + " is not a name");
  return json.get<std::string>();
}

/// One name or a list of them.
std::vector<std::string> names(const Json& json, const std::string& where) {
  if (json.is_string()) return {text(json, where)};
  if (!json.is_array()) throw Fault(where + " is neither a name nor a list of names");
  std::vector<std::string> all;
  for (const Json& item : json) all.push_back(text(item, where));
  return all;
}

void for_each(
    const Json& json, const std::string& where,
    const std::function<void(const std::string& key, const Json& value, const std::string& at)>& use) {
  if (!json.is_object()) throw Fault((where.empty() ? "clip data" : where) + " is not an object");
  for (const auto& [key, value] : json.items()) use(key, value, where.empty() ? key : where + "." + key);
}

[[noreturn]] void unknown(const std::string& at) {
  throw Fault("unknown key '" + at + "'");
}

/// Up to sixteen bytes: of a text, or numbers of 0 to 255.
std::array<std::byte, 16> payload(const Json& json, const std::string& where) {
  std::array<std::byte, 16> bytes = {};
  std::vector<int> values;
  if (json.is_string())
    for (const char c : json.get<std::string>()) values.push_back(static_cast<unsigned char>(c));
  else if (json.is_array())
    for (const Json& item : json) values.push_back(static_cast<int>(number(item, where)));
  else
    throw Fault(where + " is neither a text nor a list of bytes");
  if (values.size() > bytes.size()) throw Fault(where + " is longer than 16 bytes");
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] < 0 || values[k] > 255) throw Fault(where + " has a number that is no byte");
    bytes[k] = static_cast<std::byte>(values[k]);
  }
  return bytes;
}

EventEntry event(const Json& json, const std::string& where, double begin) {
  EventEntry e;
  std::optional<double> time, from, to;
  for_each(json, where, [&](const std::string& key, const Json& value, const std::string& at) {
    if (key == "name")
      e.name = text(value, at);
    else if (key == "time")
      time = number(value, at);
    else if (key == "from")
      from = number(value, at);
    else if (key == "to")
      to = number(value, at);
    else if (key == "always")
      e.always = truth(value, at);
    else if (key == "payload")
      e.payload = payload(value, at);
    else
      unknown(at);
  });
  if (e.name.empty()) throw Fault(where + " has no name");
  if (time.has_value() == (from.has_value() || to.has_value()) || from.has_value() != to.has_value())
    throw Fault(where + " ('" + e.name + "') needs either 'time' or 'from' and 'to'");
  e.begin = (time ? *time : *from) - begin;
  e.end = (time ? *time : *to) - begin;
  if (e.end < e.begin) throw Fault(where + " ('" + e.name + "') ends before it begins");
  return e;
}

CurveKeys curve(const Json& json, const std::string& where, double begin) {
  CurveKeys out;
  const Json* keys = &json;
  if (json.is_object()) {
    keys = nullptr;
    for_each(json, where, [&](const std::string& key, const Json& value, const std::string& at) {
      if (key == "keys")
        keys = &value;
      else if (key == "smooth")
        out.smooth = truth(value, at);
      else
        unknown(at);
    });
  }
  if (!keys || !keys->is_array() || keys->empty()) throw Fault(where + " has no keys");
  for (const Json& key : *keys) {
    if (!key.is_array() || key.size() != 2) throw Fault(where + ": a key is not [time, value]");
    const double time = number(key[0], where) - begin;
    if (!out.keys.empty() && !(time > out.keys.back().first)) throw Fault(where + ": key times do not rise");
    out.keys.emplace_back(time, number(key[1], where));
  }
  return out;
}

PhaseMarker marker(const Json& json, const std::string& where, double begin) {
  PhaseMarker m;
  int given = 0;
  for_each(json, where, [&](const std::string& key, const Json& value, const std::string& at) {
    if (key == "phase")
      m.phase = number(value, at);
    else if (key == "time")
      m.time = number(value, at) - begin;
    else
      unknown(at);
    ++given;
  });
  if (given != 2) throw Fault(where + " needs 'phase' and 'time'");
  return m;
}

/// A list's items, each named by its place.
template <class Item>
std::vector<Item> list(const Json& json, const std::string& where, double begin,
                       Item (*read)(const Json&, const std::string&, double)) {
  if (!json.is_array()) throw Fault(where + " is not a list");
  std::vector<Item> items;
  for (std::size_t k = 0; k < json.size(); ++k)
    items.push_back(read(json[k], where + "[" + std::to_string(k) + "]", begin));
  return items;
}

void read_entry(const Json& json, const std::string& where, double begin, ClipEntry& entry) {
  for_each(json, where, [&](const std::string& key, const Json& value, const std::string& at) {
    if (key == "loops")
      entry.loops = truth(value, at);
    else if (key == "strengthens")
      entry.strengthens = truth(value, at);
    else if (key == "events")
      entry.events = list(value, at, begin, event);
    else if (key == "curves")
      for_each(value, at, [&](const std::string& name, const Json& keys, const std::string& place) {
        entry.curves[name] = curve(keys, place, begin);
      });
    else if (key == "markers")
      entry.markers = list(value, at, begin, marker);
    else if (key == "cycles") {
      const double cycles = number(value, at);
      if (cycles < 1 || cycles > 1000 || cycles != std::floor(cycles))
        throw Fault(at + " is not a whole number of 1 to 1000");
      entry.cycles = static_cast<int>(cycles);
    } else
      unknown(at);
  });
}

MaskEntry mask(const Json& json, const std::string& where) {
  MaskEntry m;
  for_each(json, where, [&](const std::string& key, const Json& value, const std::string& at) {
    if (key == "from")
      m.from = names(value, at);
    else if (key == "without")
      m.without = names(value, at);
    else if (key == "weight")
      m.weight = number(value, at);
    else if (key == "feather")
      m.feather = static_cast<int>(number(value, at));
    else if (key == "joints")
      for_each(value, at, [&](const std::string& joint, const Json& weight, const std::string& place) {
        m.joints[joint] = number(weight, place);
      });
    else
      unknown(at);
  });
  if (m.from.empty() && m.joints.empty())
    throw Fault(where + " reaches no joint: neither 'from' nor 'joints'");
  if (m.feather < 0 || m.feather > 100) throw Fault(where + ".feather is not within 0 and 100");
  const auto outside = [](double w) { return !(w >= 0 && w <= 1); };
  if (outside(m.weight)) throw Fault(where + ".weight is not within 0 and 1");
  for (const auto& [joint, weight] : m.joints)
    if (outside(weight)) throw Fault(where + ".joints." + joint + " is not within 0 and 1");
  return m;
}

template <class Read>
Error guarded(const Read& read) {
  try {
    read();
  } catch (const Fault& fault) {
    return {fault.what()};
  }
  return {};
}

/// Joints of that name, or of that role where none has it.
std::vector<int> joints_named(const std::string& name, const Skeleton& skeleton, const std::string& where) {
  std::vector<int> found;
  const Role role = role_from_name(name);
  for (const bool by_role : {false, true})
    for (std::size_t j = 0; j < skeleton.joints.size() && (found.empty() || by_role); ++j) {
      const Joint& joint = skeleton.joints[j];
      const bool fits = by_role ? role != Role::kNone && joint.role == role : joint.name == name;
      if (fits && std::find(found.begin(), found.end(), static_cast<int>(j)) == found.end())
        found.push_back(static_cast<int>(j));
    }
  if (found.empty()) throw Fault(where + ": there is no joint '" + name + "'");
  return found;
}

JointMask spread(const std::string& name, const MaskEntry& entry, const Skeleton& skeleton) {
  const std::string where = "mask '" + name + "'";
  const std::size_t count = skeleton.joints.size();
  std::vector<double> weights(count, 0);
  std::vector<int> depth(count, -1);  // below the first joint reached
  const auto below = [&](const std::vector<std::string>& roots, const auto& use) {
    std::fill(depth.begin(), depth.end(), -1);
    for (const std::string& root : roots)
      for (const int j : joints_named(root, skeleton, where)) depth[static_cast<std::size_t>(j)] = 0;
    for (std::size_t j = 0; j < count; ++j) {  // parents come first
      const int parent = skeleton.joints[j].parent;
      if (depth[j] < 0 && parent >= 0 && depth[static_cast<std::size_t>(parent)] >= 0)
        depth[j] = depth[static_cast<std::size_t>(parent)] + 1;
      if (depth[j] >= 0) use(j, depth[j]);
    }
  };
  below(entry.from, [&](std::size_t j, int d) {
    weights[j] = entry.weight * std::min(1.0, (d + 1.0) / (entry.feather + 1.0));
  });
  below(entry.without, [&](std::size_t j, int) { weights[j] = 0; });
  for (const auto& [joint, weight] : entry.joints)
    for (const int j : joints_named(joint, skeleton, where)) weights[static_cast<std::size_t>(j)] = weight;
  JointMask out{name, {}};
  for (const double w : weights) out.weights.push_back(static_cast<std::uint8_t>(std::lround(255 * w)));
  return out;
}

/// A time of a clip, which rounding may have carried beyond its ends.
double within(double time, const Clip& clip, const std::string& what) {
  if (time < -kRounding || time > double(clip.duration) + kRounding)
    throw Fault(what + " at " + std::to_string(time) + " s is not within the clip's " +
                std::to_string(clip.duration) + " s");
  return std::clamp(time, 0.0, double(clip.duration));
}

/// Straight lines between keys, level beyond the first and the last; around the seam of a loop, from the last
/// to the first.
class Polyline {
 public:
  Polyline(const CurveKeys& keys, double duration, bool loops) {
    keys_ = keys.keys;
    if (!loops) return;
    const auto first = keys_.front(), last = keys_.back();
    if (first.first + duration > last.first + 1e-9) keys_.emplace_back(first.first + duration, first.second);
    if (last.first - duration < first.first - 1e-9)
      keys_.insert(keys_.begin(), {last.first - duration, last.second});
  }

  double operator()(double t) const {
    if (t <= keys_.front().first) return keys_.front().second;
    if (t >= keys_.back().first) return keys_.back().second;
    const auto after = std::upper_bound(keys_.begin(), keys_.end(), t,
                                        [](double time, const auto& key) { return time < key.first; });
    const auto before = after - 1;
    const double part = (t - before->first) / (after->first - before->first);
    return before->second + part * (after->second - before->second);
  }

 private:
  std::vector<std::pair<double, double>> keys_;
};

/// The C² cubic through keys (natural at the ends, periodic around the seam of a loop), by its slopes.
class SmoothLine {
 public:
  SmoothLine(const CurveKeys& keys, double duration, bool loops) : loops_(loops), duration_(duration) {
    for (const auto& [time, value] : keys.keys) {
      if (loops && !times_.empty() && time >= times_.front() + duration - 1e-9) continue;  // the first again
      times_.push_back(time);
      values_.push_back(value);
    }
    solve();
  }

  double operator()(double t) const {
    const std::size_t n = times_.size();
    if (n == 1) return values_[0];
    if (loops_) {
      t = times_[0] + std::fmod(t - times_[0], duration_);
      if (t < times_[0]) t += duration_;
    } else if (t <= times_.front() || t >= times_.back()) {
      return t <= times_.front() ? values_.front() : values_.back();
    }
    const std::size_t i =
        static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin()) - 1;
    const double h = length(i), u = (t - times_[i]) / h;
    const double v0 = values_[i], v1 = values_[(i + 1) % n], s0 = h * slopes_[i],
                 s1 = h * slopes_[(i + 1) % n];
    return v0 + u * (s0 + u * (3 * (v1 - v0) - 2 * s0 - s1 + u * (2 * (v0 - v1) + s0 + s1)));
  }

 private:
  double length(std::size_t i) const {
    return i + 1 < times_.size() ? times_[i + 1] - times_[i] : times_[0] + duration_ - times_[i];
  }

  /// Second derivatives meet at every key. Relaxed: the matrix is dominated by its diagonal.
  void solve() {
    const std::size_t n = times_.size();
    slopes_.assign(n, 0);
    if (n < 2) return;
    const auto secant = [&](std::size_t i) { return (values_[(i + 1) % n] - values_[i]) / length(i); };
    for (int round = 0; round < 100; ++round)
      for (std::size_t i = 0; i < n; ++i) {
        const bool first = !loops_ && i == 0, last = !loops_ && i + 1 == n;
        const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
        if (first) {
          slopes_[i] = (3 * secant(0) - slopes_[1]) / 2;
        } else if (last) {
          slopes_[i] = (3 * secant(before) - slopes_[before]) / 2;
        } else {
          const double a = 1 / length(before), b = 1 / length(i);
          slopes_[i] = (3 * (a * secant(before) + b * secant(i)) - a * slopes_[before] - b * slopes_[after]) /
                       (2 * (a + b));
        }
      }
  }

  bool loops_;
  double duration_;
  std::vector<double> times_, values_, slopes_;
};

/// Value of a uniform cubic B-spline.
double at_knots(const std::vector<double>& controls, double knots, bool loops) {
  const int count = static_cast<int>(controls.size()), spans = loops ? count : count - 3;
  const int first = std::clamp(static_cast<int>(knots), 0, spans - 1);
  const std::array<double, 6> w = BsplineBasis<double>::at(3, knots - first).value;
  double sum = 0;
  for (int k = 0; k < 4; ++k)
    sum += w[static_cast<std::size_t>(k)] * controls[static_cast<std::size_t>((first + k) % count)];
  return sum;
}

/// Controls on `spans` even spans of what `line` says. `sharpen`: so that the spline goes through its knots;
/// else they are the line's own values, and the spline stays between the least and the greatest of them.
template <class Line>
std::vector<double> controls_of(const Line& line, double duration, int spans, bool loops, bool sharpen) {
  const int count = loops ? spans : spans + 3;
  const double h = duration / spans;
  std::vector<double> wanted, controls;
  for (int k = 0; k < count; ++k) {
    const double t = (k - 1) * h;
    wanted.push_back(line(loops ? t : std::clamp(t, 0.0, duration)));
  }
  controls = wanted;
  const auto straighten_ends =
      [&] {  // a line that begins at an angle is not bent there, nor leaves its range
        if (loops) return;
        controls[0] = 2 * controls[1] - controls[2];
        const auto last = static_cast<std::size_t>(count - 1);
        controls[last] = 2 * controls[last - 1] - controls[last - 2];
      };
  straighten_ends();
  for (int round = 0; sharpen && round < 60; ++round) {  // (c₋₁ + 4c + c₁)/6 = wanted
    for (int k = loops ? 0 : 1; k < (loops ? count : count - 1); ++k) {
      const double before = controls[static_cast<std::size_t>((k + count - 1) % count)],
                   after = controls[static_cast<std::size_t>((k + 1) % count)];
      controls[static_cast<std::size_t>(k)] = (6 * wanted[static_cast<std::size_t>(k)] - before - after) / 4;
    }
    straighten_ends();
  }
  return controls;
}

template <class Line>
FloatCurve fit_line(const Line& line, const CurveKeys& keys, double duration, bool loops) {
  double low = keys.keys.front().second, high = low;
  for (const auto& [time, value] : keys.keys) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  FloatCurve curve;
  const double length = std::max(duration, kShortestKnot);
  const double most =
      kCloseness * (high - low) + 1e-9 * (std::abs(low) + std::abs(high));  // and its rounding
  std::vector<double> controls;
  for (int spans = 1;; spans *= 2) {
    controls = controls_of(line, length, spans, loops, keys.smooth);
    curve.knot_interval = static_cast<float>(length / spans);
    double off = 0;
    const auto judge = [&](double t) {
      off = std::max(off, std::abs(at_knots(controls, t / length * spans, loops) - line(t)));
    };
    for (int k = 0; k <= kBetween * spans; ++k) judge(length * k / (kBetween * spans));
    for (const auto& [time, value] : keys.keys) judge(std::clamp(time, 0.0, length));
    if (off <= most || length / (2 * spans) < kShortestKnot) break;
  }
  for (const double c : controls) curve.controls.push_back(static_cast<float>(c));
  return curve;
}

void add_clip(const ClipEntry& entry, Asset& asset, Clip& clip) {
  const std::string where = "clip '" + clip.name + "': ";
  for (const auto& [name, keys] : entry.curves) {
    const std::string what = where + "curve '" + name + "': a key";
    CurveKeys inside = keys;
    for (auto& [time, value] : inside.keys) time = within(time, clip, what);
    FloatCurve fitted = fit_curve(inside, double(clip.duration), clip.loops);
    fitted.slot = asset.find_curve(name);
    std::erase_if(clip.curves, [&](const FloatCurve& c) { return c.slot == fitted.slot; });
    clip.curves.push_back(std::move(fitted));
  }
  std::sort(clip.curves.begin(), clip.curves.end(),
            [](const FloatCurve& a, const FloatCurve& b) { return a.slot < b.slot; });
  for (const EventEntry& e : entry.events.value_or(std::vector<EventEntry>())) {
    const std::string what = where + "event '" + e.name + "'";
    ClipEvent event;
    event.begin = static_cast<float>(within(e.begin, clip, what));
    event.end = static_cast<float>(within(e.end, clip, what));
    event.name = event_name(e.name);
    event.always = e.always;
    event.payload = e.payload;
    clip.events.push_back(event);
  }
  std::stable_sort(clip.events.begin(), clip.events.end(),
                   [](const ClipEvent& a, const ClipEvent& b) { return a.begin < b.begin; });
  if (entry.markers.empty()) return;
  clip.cycles = entry.cycles;
  clip.markers.clear();
  for (PhaseMarker m : entry.markers) {
    m.time = within(m.time, clip, where + "marker");
    clip.markers.push_back(m);
  }
  PhaseMap ignored;
  if (!clip.loops) throw Fault(where + "has markers, but does not loop");
  if (Status status = fit_phase_map(clip.markers, double(clip.duration), clip.cycles, ignored); !status)
    throw Fault(where + "marker " + std::to_string(status.index) + ": " + status.reason);
}

void add_all(const ClipData& data, bool may_miss, Asset& asset, Json& report) {
  std::map<std::string, double> slots = data.curves;
  std::set<std::string> events;
  for (const auto& [name, entry] : data.clips) {
    if (asset.find_clip(name) < 0) {
      if (may_miss) continue;
      std::string there;
      for (const Clip& clip : asset.clips) there += (there.empty() ? "" : ", ") + clip.name;
      throw Fault("there is no clip '" + name + "'" + (there.empty() ? "" : ", but " + there));
    }
    for (const auto& [curve, keys] : entry.curves) slots.emplace(curve, 0);
    for (const EventEntry& e : entry.events.value_or(std::vector<EventEntry>())) events.insert(e.name);
  }
  for (const auto& [name, rest] : slots)  // clips of other skeletons may have brought theirs
    if (const int slot = asset.find_curve(name); slot < 0)
      asset.curve_slots.push_back({name, static_cast<float>(rest)});
    else if (data.curves.count(name) > 0)
      asset.curve_slots[static_cast<std::size_t>(slot)].rest = static_cast<float>(rest);
  events.insert(asset.event_names.begin(), asset.event_names.end());
  asset.event_names.assign(events.begin(), events.end());
  for (const auto& [name, entry] : data.masks) {
    asset.masks.push_back(spread(name, entry, asset.skeleton));
    report["masks"].push_back(name);
  }
  for (const CurveSlot& slot : asset.curve_slots) report["curves"].push_back(slot.name);
  for (std::size_t c = 0; c < asset.clips.size(); ++c) {
    Clip& clip = asset.clips[c];
    const auto entry = data.clips.find(clip.name);
    if (entry != data.clips.end()) add_clip(entry->second, asset, clip);
    Json& line = report["clips"][c];
    line["contacts"] = clip.contacts.size();
    line["curves"] = clip.curves.size();
    line["events"] = clip.events.size();
    line["markers"] = clip.markers.size();
  }
  if (Status status = validate_names(asset); !status) throw Fault(status.reason);
}

}  // namespace

FloatCurve fit_curve(const CurveKeys& keys, double duration, bool loops) {
  return keys.smooth ? fit_line(SmoothLine(keys, duration, loops), keys, duration, loops)
                     : fit_line(Polyline(keys, duration, loops), keys, duration, loops);
}

Error ClipData::read(const Json& json) {
  return guarded([&] {
    for_each(json, "", [&](const std::string& key, const Json& value, const std::string& at) {
      if (key == "curves")
        for_each(value, at, [&](const std::string& name, const Json& rest, const std::string& place) {
          curves[name] = number(rest, place);
        });
      else if (key == "masks")
        for_each(value, at, [&](const std::string& name, const Json& rule, const std::string& place) {
          masks[name] = mask(rule, place);
        });
      else if (key == "clips")
        for_each(value, at, [&](const std::string& name, const Json& entry, const std::string& place) {
          read_entry(entry, place, 0, clips[name]);
        });
      else
        unknown(at);
    });
  });
}

Error ClipData::read_clip(const std::string& name, const Json& json, double begin) {
  return guarded([&] { read_entry(json, "clips." + name, begin, clips[name]); });
}

void ClipData::add(const ClipData& other) {
  for (const auto& [name, rest] : other.curves) curves[name] = rest;
  for (const auto& [name, rule] : other.masks) masks[name] = rule;
  for (const auto& [name, from] : other.clips) {
    ClipEntry& to = clips[name];
    if (from.loops) to.loops = from.loops;
    if (from.strengthens) to.strengthens = from.strengthens;
    if (from.events) to.events = from.events;
    for (const auto& [curve, keys] : from.curves) to.curves[curve] = keys;
    if (from.markers.empty()) continue;
    to.markers = from.markers;
    to.cycles = from.cycles;
  }
}

Error add_clip_data(const ClipData& data, bool may_miss, Asset& asset, Json& report) {
  return guarded([&] { add_all(data, may_miss, asset, report); });
}

}  // namespace sinew::convert
