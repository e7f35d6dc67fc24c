#include "convert/convert.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <set>

#include "convert/body.h"
#include "convert/clip_data.h"
#include "convert/contact_windows.h"
#include "convert/fit/clip_fit.h"
#include "convert/muscles.h"
#include "convert/options.h"
#include "convert/rig.h"
#include "convert/urdf_body.h"
#include "import/link_meshes.h"
#include "import/plain_words.h"

namespace sinew::convert {
namespace {

Error in_file(const std::string& path, const std::string& what) {
  return {path + ": " + what};
}

Error describe(const std::string& path, const Status& status, const Skeleton& skeleton) {
  std::string where;
  if (status.index >= 0 && status.index < static_cast<int>(skeleton.joints.size()))
    where = " (joint '" + skeleton.joints[status.index].name + "')";
  return in_file(path, status.reason + where);
}

FitOptions fit_options(const Options& options) {
  FitOptions fit;
  fit.max_error_mm = options.fit_error_mm;
  fit.skin_distance = options.fit_distance_cm / 100;
  fit.angular_acceleration = options.fit_angular;
  fit.linear_acceleration = options.fit_linear;
  fit.degree = options.fit_degree;
  return fit;
}

nlohmann::json describe(const Clip& clip, const Skeleton& skeleton, double keys_per_s,
                        const FitReport& fitted) {
  std::size_t controls = 0;
  for (const Clip::Group& group : clip.groups) controls += group.controls.size() * sizeof(float);
  const double joint_seconds = clip.joint_count * std::max(1e-3, double(clip.duration));
  return {{"name", clip.name},
          {"duration_s", clip.duration},
          {"loops", clip.loops},
          {"keys_per_s", keys_per_s},
          {"max_error_mm", fitted.max_mm},
          {"rms_error_mm", fitted.rms_mm},
          {"bytes_per_joint_second", double(file_bytes(clip, skeleton)) / joint_seconds},
          {"memory_per_joint_second", double(controls) / joint_seconds}};
}

/// Notes where a clip's curves are farther from the samples than was asked for.
void note_error(const Clip& clip, const Skeleton& skeleton, const FitReport& fitted, double asked_mm,
                nlohmann::json& report) {
  constexpr double kRounding = 1.01;  // the search reckons with doubles, clips are floats
  if (fitted.max_mm <= kRounding * asked_mm) return;
  char line[96];
  std::snprintf(line, sizeof line, "' is off by %.3g mm at %.4g s, more than the %.3g mm asked for",
                fitted.max_mm, fitted.worst_time, asked_mm);
  report["notes"].push_back("clip '" + clip.name + "': joint '" +
                            skeleton.joints[static_cast<std::size_t>(fitted.worst_joint)].name + line);
}

/// Rig joints in skeleton order.
void fit_clips(const Rig& rig, const std::vector<int>& joint_of_rig, const Options& options, Asset& asset,
               std::vector<Clip>& references, nlohmann::json& report) {
  report["clips"] = nlohmann::json::array();
  FitInput input;
  for (const Joint& joint : asset.skeleton.joints) {
    input.parents.push_back(joint.parent);
    input.rest.push_back(joint.rest.cast<float>());
  }
  for (const Rig::Motion& motion : rig.motions) {
    input.name = motion.name;
    input.loops = motion.loops;
    input.sample_rate = motion.sample_rate;
    input.times = motion.times;
    input.samples.clear();
    for (const auto& frame : motion.samples) {
      std::vector<Transform<double>> ordered(frame.size());
      for (std::size_t j = 0; j < frame.size(); ++j) ordered[joint_of_rig[j]] = frame[j];
      input.samples.push_back(std::move(ordered));
    }
    FitReport fitted;
    asset.clips.push_back(fit_clip(input, fit_options(options), fitted));
    references.push_back(std::move(fitted.reference));
    note_error(asset.clips.back(), asset.skeleton, fitted, options.fit_error_mm, report);
    report["clips"].push_back(describe(asset.clips.back(), asset.skeleton, motion.sample_rate, fitted));
  }
}

/// What the fit's knots and rounding change of the torques that clips ask for.
void report_torque_errors(const Asset& asset, const std::vector<Clip>& references, nlohmann::json& report) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    const TorqueError error = torque_error(asset.clips[i], references[i], asset.skeleton);
    report["clips"][i]["largest_torque_error"] = error.largest;
    report["clips"][i]["rms_torque_error"] = error.rms;
  }
}

/// What stands beside a source file, if anything does.
Error read_beside(const std::string& input, ClipData& data, nlohmann::json& report) {
  constexpr std::uintmax_t kLargest = 16u << 20;
  const std::string path = clip_data_beside(input);
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return {};
  if (std::filesystem::file_size(path, none) > kLargest) return in_file(path, "larger than 16 MiB");
  std::ifstream file(path);
  if (!file) return in_file(path, "file cannot be opened");
  try {
    if (Error error = data.read(nlohmann::json::parse(file, nullptr, true, true)))
      return in_file(path, error.message);
  } catch (const nlohmann::json::exception& e) {
    return in_file(path, "not JSON: " + import::plain_words(e));
  }
  report["notes"].push_back("clips also from " + std::filesystem::path(path).filename().string());
  return {};
}

/// What a glTF says of itself under "sinew" in its extras: an object, or one as text, as some exporters write
/// it.
Error read_extras(const std::string& extras, const std::function<Error(const nlohmann::json&)>& read) {
  if (extras.empty()) return {};
  const nlohmann::json all = nlohmann::json::parse(extras, nullptr, false);
  if (!all.is_object() || !all.contains("sinew")) return {};
  const nlohmann::json& own = all["sinew"];
  const nlohmann::json data =
      own.is_string() ? nlohmann::json::parse(own.get<std::string>(), nullptr, false) : own;
  if (data.is_discarded()) return {"extras.sinew is no JSON"};
  if (Error error = read(data)) return {"extras.sinew: " + error.message};
  return {};
}

/// Weights of morph targets are curves; JSON that has one of that name counts instead.
void add_morph_weights(const Rig& rig, ClipData& data) {
  for (const auto& [name, rest] : rig.morph_rest) data.curves.emplace(name, rest);
  for (const Rig::Motion& motion : rig.motions)
    for (const auto& [name, keys] : motion.morph_keys)
      if (rig.morph_rest.count(name) > 0)
        data.clips[motion.name].curves.emplace(name, CurveKeys{keys, false});
}

/// All that is said of clips beside their motion: in the sources, in files beside them, in the options; what
/// comes later counts.
Error gather(const std::vector<std::string>& inputs, const std::vector<import::SourceScene>& scenes,
             const Options& options, const Rig& rig, ClipData& data, nlohmann::json& report) {
  const auto is_foreign = [&](std::size_t scene) {  // it says what it says when it is added
    return std::any_of(rig.foreign.begin(), rig.foreign.end(),
                       [&](const Rig::Foreign& f) { return f.scene == scene; });
  };
  for (std::size_t i = 0; i < scenes.size(); ++i)
    if (Error error =
            is_foreign(i) ? Error{} : read_extras(scenes[i].extras, [&](const nlohmann::json& json) {
              return data.read(json);
            }))
      return in_file(inputs[i], error.message);
  add_morph_weights(rig, data);
  for (const Rig::Motion& motion : rig.motions)
    if (Error error = read_extras(motion.extras, [&](const nlohmann::json& json) {
          return data.read_clip(motion.name, json, motion.begin);
        }))
      return in_file(inputs[0], "animation '" + motion.name + "': " + error.message);
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (Error error = is_foreign(i) ? Error{} : read_beside(inputs[i], data, report)) return error;
  data.add(options.clip_data);
  return {};
}

/// Notes a figure of human parts that is too tall or too heavy for one: a unit or a mass is wrong, or it is a
/// giant.
void note_odd_size(const Skeleton& skeleton, double height, nlohmann::json& report) {
  constexpr double kShortest = 0.4, kTallest = 2.75;  // m: newborn children, R. Wadlow
  constexpr double kLeanest = 10, kHeaviest = 60;     // kg/m²
  const auto has = [&](Role role) {
    return std::any_of(skeleton.joints.begin(), skeleton.joints.end(),
                       [&](const Joint& j) { return j.role == role; });
  };
  if (!has(Role::kPelvis) || !has(Role::kHead) || !(height > 0)) return;
  char line[160];
  const double mass = skeleton.total_mass(), index = mass / (height * height);
  if (height < kShortest || height > kTallest) {
    std::snprintf(line, sizeof line, "no human is %.2f m tall; if it is one, its unit is wrong (--unit)",
                  height);
    report["notes"].push_back(line);
  } else if (index < kLeanest || index > kHeaviest) {
    std::snprintf(line, sizeof line,
                  "no human of %.2f m weighs %.1f kg; if it is one, its mass is wrong (option total_mass)",
                  height, mass);
    report["notes"].push_back(line);
  }
}

/// Refuses files for another skeleton, and says what can be done with them.
Error refuse_foreign(const std::vector<std::string>& inputs, const Rig& rig) {
  if (rig.foreign.empty()) return {};
  const Rig::Foreign& first = rig.foreign.front();
  const std::string& clips = inputs[first.scene];
  const std::string& character = inputs[first.scene == 0 && inputs.size() > 1 ? 1 : 0];
  return in_file(clips, first.why + "; fit it to this one with: sinew retarget " + clips + " --to " +
                            character + " -o OUT.sinew, or convert with --retarget");
}

/// Has clips of other skeletons added; all that were asked for must be there then.
Error add_foreign_clips(const std::vector<std::string>& inputs, const Rig& rig, const Options& options,
                        const AddForeignClips& add, Asset& asset, nlohmann::json& report) {
  for (const Rig::Foreign& foreign : rig.foreign)
    if (Error error = add(inputs[foreign.scene], options, asset, report)) return error;
  for (const std::string& wanted : options.clips)
    if (asset.find_clip(wanted) < 0) return in_file(inputs[0], "it has no clip '" + wanted + "'");
  return {};
}

/// Those that muscles are made for.
std::vector<Clip> demanding_clips(const std::vector<Clip>& clips, const ClipData& data) {
  std::vector<Clip> demanding;
  for (const Clip& clip : clips) {
    const auto entry = data.clips.find(clip.name);
    if (entry == data.clips.end() || entry->second.strengthens.value_or(true)) demanding.push_back(clip);
  }
  return demanding;
}

/// Once the asset's curves are known.
void find_morph_curves(const std::vector<std::vector<std::string>>& names, Asset& asset,
                       nlohmann::json& report) {
  std::set<std::string> all;
  for (std::size_t m = 0; m < names.size(); ++m)
    for (const std::string& name : names[m]) {
      asset.meshes[m].morph_curves.push_back(asset.find_curve(name));
      all.insert(name);
    }
  if (!all.empty()) report["morph_targets"] = all;
}

Error convert_scenes(const std::vector<std::string>& inputs, const std::vector<import::SourceScene>& scenes,
                     const Options& options, const AddForeignClips& add_foreign, Asset& out,
                     nlohmann::json& report) {
  Asset asset;
  ClipData data;
  std::vector<std::vector<std::string>> morph_names;  // [mesh][morph]
  if (scenes[0].format == "urdf") {
    if (scenes.size() > 1) return in_file(inputs[1], "a URDF takes no further files");
    if (Error error = build_urdf(scenes[0], options, asset, report)) return in_file(inputs[0], error.message);
    if (Error error = override_masses(options, false, asset.skeleton))
      return in_file(inputs[0], error.message);
    if (Error error = gather(inputs, scenes, options, {}, data, report)) return error;
  } else {
    Rig rig;
    if (Error error = build_rig(scenes, options, rig, report)) return in_file(inputs[0], error.message);
    if (!options.retarget || !add_foreign)
      if (Error error = refuse_foreign(inputs, rig)) return error;
    if (Error error = gather(inputs, scenes, options, rig, data, report)) return error;
    for (Rig::Motion& motion : rig.motions)
      if (const auto entry = data.clips.find(motion.name); entry != data.clips.end())
        motion.loops = entry->second.loops.value_or(motion.loops);
    std::vector<int> joint_of_rig;
    asset.skeleton = build_body(rig, options, joint_of_rig, report);
    asset.skeleton.name = scenes[0].name;
    if (Error error = override_masses(options, true, asset.skeleton))
      return in_file(inputs[0], error.message);
    std::vector<Clip> references;
    fit_clips(rig, joint_of_rig, options, asset, references, report);
    if (Status status = validate(asset.skeleton); !status) return describe(inputs[0], status, asset.skeleton);
    for (Clip& clip : asset.clips) find_contacts(asset.skeleton, rig.height, clip, report);
    note_odd_size(asset.skeleton, rig.height, report);
    asset.meshes = std::move(rig.meshes);
    morph_names = std::move(rig.morph_names);
    for (Mesh& mesh : asset.meshes)
      for (std::uint16_t& j : mesh.joints) j = static_cast<std::uint16_t>(joint_of_rig[j]);
    asset.materials = std::move(rig.materials);
    asset.inverse_bind.resize(rig.joints.size());
    for (std::size_t j = 0; j < rig.joints.size(); ++j)
      asset.inverse_bind[joint_of_rig[j]] = rig.joints[j].rest.inverse().cast<float>();
    if (Error error = add_foreign_clips(inputs, rig, options, add_foreign, asset, report)) return error;
    strengthen(demanding_clips(asset.clips, data), options.strength_margin, asset.skeleton, report);
    report_torque_errors(asset, references, report);
  }
  if (Error error = add_clip_data(data, !options.clips.empty(), asset, report))
    return in_file(inputs[0], "clip data: " + error.message);
  find_morph_curves(morph_names, asset, report);
  override_limits(options, asset.skeleton);
  if (Status status = validate(asset.skeleton); !status) return describe(inputs[0], status, asset.skeleton);
  for (const Clip& clip : asset.clips)
    if (Status status = validate(clip); !status)
      return in_file(inputs[0], "clip '" + clip.name + "': " + status.reason);
  report["files"] = scenes[0].files;
  report["format"] = scenes[0].format;
  report["name"] = asset.skeleton.name;
  report["joints"] = asset.skeleton.joints.size();
  report["simulated_joints"] = asset.skeleton.body_count;
  report["dofs"] = asset.skeleton.dof_total();
  asset.report_json = report.dump();
  out = std::move(asset);
  return {};
}

}  // namespace

Error convert_files(const std::vector<std::string>& inputs, const nlohmann::json& json, Asset& out,
                    nlohmann::json& report, const AddForeignClips& add_foreign) {
  if (inputs.empty()) return {"no input file"};
  Options options;
  if (Error error = Options::parse(json, options)) return in_file(inputs[0], error.message);
  std::vector<import::SourceScene> scenes(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::string error;
    if (!import::read_source(inputs[i], {}, scenes[i], error)) return in_file(inputs[i], error);
    if (scenes[i].format == "urdf") import::read_link_meshes(inputs[i], options.packages, {}, scenes[i]);
  }
  report = nlohmann::json::object();
  try {
    return convert_scenes(inputs, scenes, options, add_foreign, out, report);
  } catch (const std::bad_alloc&) {
    return in_file(inputs[0], "not enough memory to convert it");
  }
}

Error open_any(const std::string& path, const nlohmann::json& options, Asset& out, nlohmann::json& report) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return in_file(path, "file cannot be opened");
  char head[8] = {};
  file.read(head, 8);
  if (std::string(head + 4, 4) != "SNEW") return convert_files({path}, options, out, report);
  Asset asset;
  if (Status status = load_asset(path.c_str(), asset); !status) return describe(path, status, asset.skeleton);
  report = nlohmann::json::parse(asset.report_json, nullptr, false);
  if (report.is_discarded()) report = nlohmann::json::object();
  out = std::move(asset);
  return {};
}

std::string clip_data_beside(const std::string& input) {
  return std::filesystem::path(input).replace_extension(".clips.json").string();
}

}  // namespace sinew::convert
