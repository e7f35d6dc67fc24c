#include "cli/export.h"

#include <algorithm>
#include <filesystem>

#include "cli/files.h"
#include "export/bvh.h"
#include "export/mjcf.h"
#include "export/urdf.h"
#include "scene/run.h"

namespace sinew::cli {
namespace {

using convert::Error;
using exporting::Motion;

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

bool is_gltf(const std::string& ending) {
  return ending == ".glb" || ending == ".gltf";
}

/// Formats that hold a physical body and no motion.
bool is_body(const std::string& ending) {
  return ending == ".xml" || ending == ".urdf";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::vector<std::string> clip_names(const Asset& asset) {
  std::vector<std::string> names;
  for (const Clip& clip : asset.clips) names.push_back(clip.name);
  return names;
}

/// Indices of the clips that are asked for; all without names.
Error chosen_clips(const Asset& asset, const std::vector<std::string>& names, std::vector<int>& out) {
  for (std::size_t i = 0; i < asset.clips.size() && names.empty(); ++i) out.push_back(static_cast<int>(i));
  for (const std::string& name : names) {
    const int clip = asset.find_clip(name);
    if (clip < 0) return {"it has no clip '" + name + "' (" + listed(clip_names(asset)) + ")"};
    if (std::find(out.begin(), out.end(), clip) == out.end()) out.push_back(clip);
  }
  return {};
}

Error chosen_characters(const scene::Recording& recording, const std::string& name, std::vector<int>& out) {
  for (std::size_t n = 0; n < recording.names.size(); ++n)
    if (name.empty() || recording.names[n] == name) out.push_back(static_cast<int>(n));
  if (!name.empty() && out.empty())
    return {"it has no character '" + name + "' (" + listed(recording.names) + ")"};
  return {};
}

void describe(const Motion& motion, nlohmann::json& report) {
  for (const auto& known : report["animations"])
    if (known["name"] == motion.name) return;  // of another character
  report["animations"].push_back(
      {{"name", motion.name}, {"keys", motion.times.size()}, {"duration_s", motion.times.back()}});
}

Error write(const std::string& bytes, const Export& what, nlohmann::json& report) {
  if (Error error = write_atomically(what.output, bytes)) return error;
  report["output"] = what.output;
  report["bytes"] = bytes.size();
  return {};
}

exporting::GltfContent content_of(const Export& what) {
  exporting::GltfContent content;
  content.surface = what.surface;
  content.cubic = what.cubic;
  content.binary = ending_of(what.output) == ".glb";
  return content;
}

/// The scene's bodies beside its characters.
void add_props(const scene::Recording& recording, const std::string& motion,
               exporting::GltfContent& content) {
  for (std::size_t p = 0; p < recording.props.size(); ++p) {
    exporting::GltfProp prop{recording.props[p], {}, {}, {}, motion};
    for (const scene::Frame& frame : recording.frames) {
      prop.times.push_back(frame.time);
      prop.poses.push_back(frame.props[p].world);
      prop.hidden.push_back(frame.props[p].world.translation.z() <= scene::kHidden);
    }
    content.props.push_back(std::move(prop));
  }
}

Error write_gltf(const exporting::GltfContent& content, const Export& what, nlohmann::json& report) {
  return write(exporting::write_gltf(content), what, report);
}

Error write_bvh(const Skeleton& skeleton, const Motion& motion, const Export& what, nlohmann::json& report) {
  std::string text;
  std::vector<std::string> notes;
  if (Error error = exporting::write_bvh(skeleton, motion, text, notes)) return error;
  report["notes"] = notes;
  return write(text, what, report);
}

/// The physical body alone: MJCF or URDF.
Error write_body(const Skeleton& skeleton, const Export& what, nlohmann::json& report) {
  std::string text;
  std::vector<std::string> notes;
  if (ending_of(what.output) == ".xml")
    text = exporting::write_mjcf(skeleton, notes);
  else if (Error error = exporting::write_urdf(skeleton, text, notes))
    return error;
  report["notes"] = notes;
  return write(text, what, report);
}

/// The one clip that goes into a BVH file; without clips, the pose at rest.
Error bvh_of_asset(const Asset& asset, const std::vector<int>& clips, const Export& what,
                   nlohmann::json& report) {
  if (clips.size() > 1) return {"BVH holds one clip: choose with --clip (" + listed(clip_names(asset)) + ")"};
  Motion motion{"rest", nullptr, {0}, {std::vector<JointJet<double>>(asset.skeleton.joints.size())}};
  for (std::size_t j = 0; j < asset.skeleton.joints.size(); ++j) {
    motion.frames[0][j].rotation = asset.skeleton.joints[j].rest.rotation;
    motion.frames[0][j].translation = asset.skeleton.joints[j].rest.translation;
  }
  if (!clips.empty())
    motion = exporting::sample_clip(asset, asset.clips[static_cast<std::size_t>(clips[0])], what.rate,
                                    exporting::Keys::kEven);
  describe(motion, report);
  return write_bvh(asset.skeleton, motion, what, report);
}

Error gltf_of_asset(const Asset& asset, const std::vector<int>& clips, const Export& what,
                    nlohmann::json& report) {
  exporting::GltfContent content = content_of(what);
  exporting::GltfFigure figure{&asset, asset.skeleton.name, {}};
  for (const int clip : clips) {
    Motion motion = exporting::sample_clip(asset, asset.clips[static_cast<std::size_t>(clip)], what.rate,
                                           exporting::Keys::kGrid);
    const auto same = [&](const Motion& m) { return m.name == motion.name; };
    while (std::any_of(figure.motions.begin(), figure.motions.end(), same)) motion.name += "_2";
    describe(motion, report);
    figure.motions.push_back(std::move(motion));
  }
  content.figures.push_back(std::move(figure));
  return write_gltf(content, what, report);
}

Error gltf_of_scene(const scene::Recording& recording, const std::vector<int>& characters,
                    const std::string& name, const Export& what, nlohmann::json& report) {
  exporting::GltfContent content = content_of(what);
  for (const int n : characters) {
    const auto at = static_cast<std::size_t>(n);
    exporting::GltfFigure figure{recording.characters[at].get(), recording.names[at], {}};
    figure.motions.push_back(exporting::played_motion(recording, n, name));
    describe(figure.motions.back(), report);
    content.figures.push_back(std::move(figure));
  }
  if (what.character.empty()) add_props(recording, name, content);
  return write_gltf(content, what, report);
}

}  // namespace

Error Export::check() const {
  const std::string ending = ending_of(output);
  if (!is_gltf(ending) && ending != ".bvh" && !is_body(ending))
    return {output + ": what it is to be is not known by its ending: .glb, .gltf, .bvh, .xml or .urdf"};
  if (is_body(ending) && (!clips.empty() || rate_asked))
    return {std::string(clips.empty() ? "--rate" : "--clip") + " is for glTF and BVH: " + ending +
            " holds no motion"};
  if (!is_gltf(ending) && surface_asked) return {"--mesh is for glTF: " + ending + " holds no mesh"};
  if (!is_gltf(ending) && cubic)
    return {"--interpolation cubic is for glTF: " + ending + " holds no splines"};
  return {};
}

Error export_asset(const Asset& asset, const Export& what, nlohmann::json& report) {
  if (!what.character.empty()) return {"--character is for scenes"};
  if (is_body(ending_of(what.output))) return write_body(asset.skeleton, what, report);
  std::vector<int> clips;
  if (Error error = chosen_clips(asset, what.clips, clips)) return error;
  if (ending_of(what.output) == ".bvh") return bvh_of_asset(asset, clips, what, report);
  return gltf_of_asset(asset, clips, what, report);
}

Error export_scene(const scene::Scene& scene, const Export& what, nlohmann::json& report) {
  const bool bvh = ending_of(what.output) == ".bvh";
  if (is_body(ending_of(what.output)))
    return {"a scene is played: glTF and BVH hold that, " + ending_of(what.output) + " does not"};
  if (!what.clips.empty()) return {"--clip is for assets: a scene's result is one animation"};
  if (what.rate_asked) return {"--rate is for clips: a scene has a key per step (its frame_rate)"};
  if (what.cubic)
    return {"--interpolation cubic is for clips: between its steps a scene's motion is not known"};
  scene::Recording recording;
  scene::Telemetry telemetry;
  std::vector<int> characters;
  if (Error error = scene::run_scene(scene, recording, telemetry, progress_line("export: frame")))
    return error;
  if (Error error = chosen_characters(recording, what.character, characters)) return error;
  const std::string name = scene.title.empty() ? "simulation" : scene.title;
  if (!bvh) return gltf_of_scene(recording, characters, name, what, report);
  if (characters.size() != 1)
    return {"BVH holds one character: choose with --character (" + listed(recording.names) + ")"};
  const Motion motion = exporting::played_motion(recording, characters[0], name);
  describe(motion, report);
  return write_bvh(recording.characters[static_cast<std::size_t>(characters[0])]->skeleton, motion, what,
                   report);
}

std::string export_text(const nlohmann::json& report) {
  std::string text;
  char line[64];
  for (const auto& animation : report["animations"]) {
    std::snprintf(line, sizeof line, ": %.2f s, %d keys\n", animation["duration_s"].get<double>(),
                  animation["keys"].get<int>());
    text += "animation " + animation["name"].get<std::string>() + line;
  }
  for (const auto& note : report["notes"]) text += "note: " + note.get<std::string>() + "\n";
  return text + report["output"].get<std::string>() + ": " +
         std::to_string(report["bytes"].get<std::size_t>()) + " bytes\n";
}

}  // namespace sinew::cli
