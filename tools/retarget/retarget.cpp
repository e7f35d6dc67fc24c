#include "retarget/retarget.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "convert/contact_windows.h"
#include "convert/fit/clip_fit.h"
#include "convert/muscles.h"
#include "convert/options.h"
#include "convert/roles.h"
#include "retarget/landing.h"
#include "retarget/planting.h"

namespace sinew::retarget {
namespace {

using nlohmann::json;

constexpr double kStature = 1.75 / 0.9;  ///< of the leg's length
constexpr double kDegrees = 180 / std::numbers::pi;

/// What all clips are retargeted with.
struct Work {
  Skeleton source, target;
  PoseMap map;
  double pace = 1;  ///< seconds of the target's clip per second of the source's
};

Error prepare(const Asset& source, const Asset& target, const Options& options, Work& work) {
  for (const auto& [asset, which] :
       {std::pair(&source, "the clips' skeleton"), std::pair(&target, "the target")})
    if (Status status = validate(asset->skeleton); !status)
      return {std::string(which) + ": " + status.reason};
  work.source = source.skeleton;
  work.target = target.skeleton;
  if (Error error = name_roles(options.from_roles, work.source)) return {"the map, 'from': " + error.message};
  if (Error error = name_roles(options.to_roles, work.target)) return {"the map, 'to': " + error.message};
  for (Skeleton* skeleton : {&work.source, &work.target}) infer_roles(*skeleton);
  if (Error error = map_poses(work.source, !source.meshes.empty(), work.target, !target.meshes.empty(),
                              options.joints, work.map))
    return error;
  if (options.froude) work.pace = std::sqrt(work.map.scale);
  return {};
}

std::vector<ContactWindow> contacts_of(const Clip& clip, const Work& work) {
  if (!clip.contacts.empty()) return clip.contacts;
  Clip looked_at = clip;
  json ignored = {{"notes", json::array()}};
  convert::find_contacts(work.source, kStature * work.map.leg, looked_at, ignored);
  return looked_at.contacts;
}

/// The target's joint that does what a joint of the source does, or -1.
int counterpart(const PoseMap& map, int joint) {
  for (const Role role : kParts)
    if (!map.from[role].joints.empty() && map.from[role].joints.front() == joint &&
        !map.to[role].joints.empty())
      return map.to[role].joints.front();
  for (std::size_t j = 0; j < map.joints.size(); ++j)
    if (map.joints[j].a == joint && map.joints[j].b == joint) return static_cast<int>(j);
  return -1;
}

/// Names that the source's clips use and the target's do not have yet.
void take_names(const Asset& source, Asset& out) {
  for (const std::string& name : source.event_names)
    if (std::find(out.event_names.begin(), out.event_names.end(), name) == out.event_names.end())
      out.event_names.push_back(name);
  for (const CurveSlot& slot : source.curve_slots)
    if (out.find_curve(slot.name) < 0) out.curve_slots.push_back(slot);
}

/// What a clip says beside its motion, in the target's time and with its joints.
void take_along(const Clip& from, const std::vector<ContactWindow>& contacts, const Asset& source,
                const Work& work, const Asset& out, Clip& clip) {
  const auto pace = static_cast<float>(work.pace);
  clip.contacts.clear();
  for (const ContactWindow& w : contacts)
    if (const int joint = counterpart(work.map, w.joint); joint >= 0 && joint < work.target.body_count)
      clip.contacts.push_back({joint, w.begin * pace, w.end * pace});
  clip.events = from.events;
  for (ClipEvent& e : clip.events) {
    e.end = std::min(e.end * pace, clip.duration);
    e.begin = std::min(e.begin * pace, e.end);
  }
  clip.curves = from.curves;
  for (FloatCurve& curve : clip.curves) {
    curve.slot = out.find_curve(source.curve_slots[curve.slot].name);
    curve.knot_interval *= pace;
  }
  std::sort(clip.curves.begin(), clip.curves.end(),
            [](const FloatCurve& a, const FloatCurve& b) { return a.slot < b.slot; });
  clip.markers = from.markers;
  for (PhaseMarker& marker : clip.markers) marker.time *= work.pace;
  clip.cycles = from.cycles;
}

Error check_finite(const Motion& motion, const Skeleton& skeleton) {
  for (const auto& frame : motion.local)
    for (std::size_t j = 0; j < frame.size(); ++j)
      if (!frame[j].rotation.coeffs().allFinite() || !frame[j].translation.allFinite())
        return {"joint '" + skeleton.joints[j].name + "' came out as no number"};
  return {};
}

json torque_report(const Clip& clip, const Skeleton& skeleton) {
  const std::vector<double> shares = convert::torque_shares(clip, skeleton);
  std::vector<int> order;
  for (int j = 0; j < int(shares.size()); ++j) order.push_back(j);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return shares[a] > shares[b]; });
  json out = json::array();
  for (const int j : order)
    if (shares[j] > 0) out.push_back({{"joint", skeleton.joints[j].name}, {"share", shares[j]}});
  return out;
}

json clip_report(const Clip& clip, const Work& work, const Retargeted& moved,
                 const convert::FitReport& fitted) {
  const double leg = work.map.leg * work.map.scale;
  const Landing landing =
      landing_of(clip, work.target, work.map.to, moved.floor, moved.carried / work.pace, leg);
  json out = {{"name", clip.name},
              {"duration_s", clip.duration},
              {"loops", clip.loops},
              {"max_error_mm", fitted.max_mm},
              {"rms_error_mm", fitted.rms_mm},
              {"contacts", landing.windows},
              {"sole_lowest_mm", 1e3 * landing.lowest},
              {"sole_highest_mm", 1e3 * landing.highest},
              {"slide_mm", 1e3 * landing.slide},
              {"knee_beyond_range_deg", kDegrees * landing.beyond},
              {"floor_m", moved.floor},
              {"torques", torque_report(clip, work.target)}};
  if (!moved.carried.isZero()) out["moves_in_place_m_s"] = moved.carried.norm() / work.pace;
  if (moved.unreachable > 0) out["frames_not_solved"] = moved.unreachable;
  return out;
}

Error retarget_clip(const Clip& from, const Asset& source, const Options& options, const Work& work,
                    Asset& out, json& report) {
  const std::vector<ContactWindow> contacts = contacts_of(from, work);
  const Motion motion = sample_motion(from, work.source);
  if (motion.local.empty()) return {"clip '" + from.name + "' cannot be sampled"};
  const Retargeted moved = retarget_motion(work.map, motion, contacts, options.plant);
  if (Error error = check_finite(moved.motion, work.target))
    return {"clip '" + from.name + "': " + error.message};
  convert::FitInput input;
  input.name = from.name;
  while (out.find_clip(input.name) >= 0) input.name += "_2";
  input.loops = from.loops;
  input.sample_rate = moved.motion.rate / work.pace;
  input.samples = moved.motion.local;
  for (const Joint& joint : work.target.joints) {
    input.parents.push_back(joint.parent);
    input.rest.push_back(joint.rest.cast<float>());
  }
  convert::FitReport fitted;
  Clip clip = convert::fit_clip(input, {}, fitted);
  take_along(from, contacts, source, work, out, clip);
  if (Status status = validate(clip); !status) return {"clip '" + from.name + "': " + status.reason};
  report["clips"].push_back(clip_report(clip, work, moved, fitted));
  out.clips.push_back(std::move(clip));
  return {};
}

json names_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  json out = json::array();
  for (const int j : joints) out.push_back(skeleton.joints[j].name);
  return out;
}

/// Which chains follow which, and what does not take part.
void describe_map(const Work& work, json& report) {
  const PoseMap& map = work.map;
  report["scale"] = map.scale;
  report["time"] = work.pace;
  report["chains"] = json::array();
  report["missing"] = json::array();
  std::vector<bool> used(work.source.joints.size(), false);
  for (const Role role : kParts) {
    const Chain &theirs = map.from[role], &ours = map.to[role];
    if (theirs.joints.empty() != ours.joints.empty())
      report["missing"].push_back(
          {{"part", convert::role_name(role)}, {"in", ours.joints.empty() ? "target" : "source"}});
    if (theirs.joints.empty() || ours.joints.empty()) continue;
    report["chains"].push_back({{"part", convert::role_name(role)},
                                {"from", names_of(work.source, theirs.joints)},
                                {"to", names_of(work.target, ours.joints)}});
    for (const int j : theirs.joints) used[j] = true;
  }
  std::vector<int> still, unused;
  json others = json::array();
  for (int j = 0; j < int(map.joints.size()); ++j) {
    if (map.joints[j].a < 0 && j == 0) continue;  // travels below the pelvis
    if (map.joints[j].a < 0) {
      still.push_back(j);
      continue;
    }
    bool in_chain = false;
    for (const Chain& chain : map.to.chains)
      in_chain = in_chain || std::find(chain.joints.begin(), chain.joints.end(), j) != chain.joints.end();
    if (!in_chain)
      others.push_back(
          {{"from", work.source.joints[map.joints[j].a].name}, {"to", work.target.joints[j].name}});
    used[map.joints[j].a] = used[map.joints[j].b] = true;
  }
  for (int j = 0; j < int(used.size()); ++j)
    if (!used[j]) unused.push_back(j);
  report["other_joints"] = others;
  report["at_rest"] = names_of(work.target, still);
  report["not_used"] = names_of(work.source, unused);
}

bool is_wanted(const Options& options, const Clip& clip) {
  return options.clips.empty() ||
         std::find(options.clips.begin(), options.clips.end(), clip.name) != options.clips.end();
}

Error check_wanted(const Asset& source, const Options& options) {
  if (source.clips.empty()) return {"the source has no clips"};
  for (const Clip& clip : source.clips)
    if (Status status = validate(clip); !status) return {"clip '" + clip.name + "': " + status.reason};
  for (const std::string& name : options.clips)
    if (source.find_clip(name) < 0) return {"the source has no clip '" + name + "'"};
  return {};
}

/// The asset's own report, of the clips that are in it now.
std::string asset_report(const Asset& target, const Asset& out, const json& report) {
  json all = json::parse(target.report_json, nullptr, false);
  if (!all.is_object()) all = json::object();
  json clips = json::array();
  for (std::size_t c = 0; c < out.clips.size() - report["clips"].size(); ++c)
    clips.push_back(all.contains("clips") && c < all["clips"].size()
                        ? all["clips"][c]
                        : json{{"name", out.clips[c].name}, {"duration_s", out.clips[c].duration}});
  for (const json& clip : report["clips"]) clips.push_back(clip);
  all["clips"] = std::move(clips);
  all["retarget"] = report;
  return all.dump();
}

Error read_names(const json& all, const char* key, std::map<std::string, std::string>& out) {
  const auto found = all.find(key);
  if (found == all.end()) return {};
  if (!found->is_object()) return {std::string("'") + key + "' is no object"};
  for (const auto& [name, value] : found->items()) {
    if (!value.is_string()) return {"'" + std::string(key) + "." + name + "' is no joint's name"};
    out[name] = value.get<std::string>();
  }
  return {};
}

}  // namespace

Error Options::read_map(const json& map) {
  if (!map.is_object()) return {"is no JSON object"};
  for (const auto& [key, value] : map.items())
    if (key != "from" && key != "to" && key != "joints") return {"unknown key '" + key + "'"};
  if (Error error = read_names(map, "from", from_roles)) return error;
  if (Error error = read_names(map, "to", to_roles)) return error;
  return read_names(map, "joints", joints);
}

Error retarget_clips(const Asset& source, const Asset& target, const Options& options, Asset& out,
                     json& report) {
  if (Error error = check_wanted(source, options)) return error;
  Work work;
  if (Error error = prepare(source, target, options, work)) return error;
  Asset asset = target;
  asset.skeleton = work.target;
  if (!options.keep_clips) asset.clips.clear();
  take_names(source, asset);
  json made = {{"clips", json::array()}};
  describe_map(work, made);
  for (const Clip& clip : source.clips)
    if (is_wanted(options, clip))
      if (Error error = retarget_clip(clip, source, options, work, asset, made)) return error;
  if (Status status = validate_names(asset); !status) return {status.reason};
  asset.report_json = asset_report(target, asset, made);
  report = std::move(made);
  out = std::move(asset);
  return {};
}

Error add_retargeted(const std::string& input, const convert::Options& conversion, Asset& character,
                     json& report) {
  json as = json::object(), ignored, made;
  if (conversion.unit > 0) as["unit"] = conversion.unit;
  if (!conversion.up.empty()) as["up"] = conversion.up;
  Asset source;
  if (Error error = convert::convert_files({input}, as, source, ignored)) return error;
  Options options;
  options.keep_clips = true;
  for (const std::string& name : conversion.clips)
    if (source.find_clip(name) >= 0) options.clips.push_back(name);
  if (!conversion.clips.empty() && options.clips.empty()) return {};
  if (Error error = retarget_clips(source, character, options, character, made))
    return {input + ": retargeting: " + error.message};
  for (const json& clip : made["clips"]) report["clips"].push_back(clip);
  report["retarget"][input] = made;
  report["notes"].push_back("'" + input + "': is for another skeleton; clips fitted to this one: " +
                            std::to_string(made["clips"].size()));
  return {};
}

std::string report_text(const json& report) {
  std::string text;
  char line[256];
  std::snprintf(line, sizeof line, "legs %.2f times as long; time times %.2f\n", report.value("scale", 1.0),
                report.value("time", 1.0));
  text += line;
  const auto list = [](const json& names) {
    std::string all;
    for (const json& name : names) all += (all.empty() ? "" : " ") + name.get<std::string>();
    return all;
  };
  for (const json& chain : report["chains"])
    text += "  " + chain.value("part", "") + ": " + list(chain["from"]) + " -> " + list(chain["to"]) + "\n";
  for (const json& part : report["missing"])
    text += "  " + part.value("part", "") + ": not in the " + part.value("in", "") + "\n";
  if (!report["other_joints"].empty())
    text += "other joints that follow one: " + std::to_string(report["other_joints"].size()) + "\n";
  if (!report["at_rest"].empty()) text += "stay at rest: " + list(report["at_rest"]) + "\n";
  if (!report["not_used"].empty()) text += "of the source, not used: " + list(report["not_used"]) + "\n";
  for (const json& clip : report["clips"]) {
    std::snprintf(line, sizeof line,
                  "clip %-20s %6.2f s%s, curves within %.2f mm; %d contacts: soles %+.1f to %+.1f mm, slide "
                  "%.1f mm; knees ",
                  clip.value("name", "").c_str(), clip.value("duration_s", 0.0),
                  clip.value("loops", false) ? " loop" : "", clip.value("max_error_mm", 0.0),
                  clip.value("contacts", 0), clip.value("sole_lowest_mm", 0.0),
                  clip.value("sole_highest_mm", 0.0), clip.value("slide_mm", 0.0));
    text += line;
    const double beyond = clip.value("knee_beyond_range_deg", 0.0);
    std::snprintf(line, sizeof line, beyond > 0 ? "%.2f degrees beyond their range" : "within their range",
                  beyond);
    text += line;
    text += "\n  torques, of what muscles have:";
    for (std::size_t k = 0; k < std::min<std::size_t>(4, clip["torques"].size()); ++k) {
      std::snprintf(line, sizeof line, "%s %s %.0f %%", k > 0 ? "," : "",
                    clip["torques"][k].value("joint", "").c_str(),
                    100 * clip["torques"][k].value("share", 0.0));
      text += line;
    }
    text += "\n";
  }
  return text;
}

}  // namespace sinew::retarget
