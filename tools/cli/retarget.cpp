#include "cli/retarget.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/files.h"
#include "cli/terminal.h"
#include "retarget/retarget.h"

namespace sinew::cli {
namespace {

using convert::Error;

bool is_asset(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char head[8] = {};
  file.read(head, 8);
  return std::string(head + 4, 4) == "SNEW";
}

/// The clips' curves, events and slots take the place of the character's own. Its morph targets follow the
/// curves of their names, at the end where no clip moves them.
void take_clips(Asset&& clips, Asset& character) {
  for (Mesh& mesh : character.meshes)
    for (int& slot : mesh.morph_curves) {
      const CurveSlot& own = character.curve_slots[static_cast<std::size_t>(slot)];
      slot = clips.find_curve(own.name);
      if (slot >= 0) continue;
      slot = static_cast<int>(clips.curve_slots.size());
      clips.curve_slots.push_back(own);
    }
  character.clips = std::move(clips.clips);
  character.curve_slots = std::move(clips.curve_slots);
  character.event_names = std::move(clips.event_names);
}

/// Clips of assets that have the joints of `character`, which takes them instead of its own.
Error add_clips(const std::string& path, Asset& character) {
  Asset clips;
  nlohmann::json report;
  if (Error error = convert::open_any(path, nlohmann::json::object(), clips, report)) return error;
  const std::vector<Joint>&a = clips.skeleton.joints, &b = character.skeleton.joints;
  if (a.size() != b.size())
    return {path + ": it has " + std::to_string(a.size()) + " joints, the character of --from " +
            std::to_string(b.size())};
  for (std::size_t j = 0; j < a.size(); ++j)
    if (a[j].name != b[j].name || a[j].parent != b[j].parent)
      return {path + ": joint '" + a[j].name + "' stands where '" + b[j].name + "' does in --from"};
  take_clips(std::move(clips), character);
  return {};
}

/// Every source of clips with the skeleton that they are for.
Error read_sources(const RetargetCommand& command, std::vector<std::pair<std::string, Asset>>& out) {
  nlohmann::json report;
  const nlohmann::json options = nlohmann::json::object();
  if (command.from.empty()) {
    for (const std::string& path : command.clips)
      if (Error error = convert::open_any(path, options, out.emplace_back(path, Asset()).second, report))
        return error;
    return {};
  }
  if (!is_asset(command.from) && std::none_of(command.clips.begin(), command.clips.end(), is_asset)) {
    std::vector<std::string> inputs{command.from};
    inputs.insert(inputs.end(), command.clips.begin(), command.clips.end());
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    return convert::convert_files(inputs, options, out.emplace_back(command.from, Asset()).second, report);
  }
  for (const std::string& path : command.clips) {
    Asset& character = out.emplace_back(path, Asset()).second;
    if (Error error = convert::open_any(command.from, options, character, report)) return error;
    if (path == command.from) continue;
    if (Error error = add_clips(path, character)) return error;
  }
  return {};
}

}  // namespace

void RetargetCommand::add(CLI::App& app) {
  app.add_option("clips", clips, "assets or source files with clips")->required()->type_name("FILE");
  app.add_option("--from", from, "the character that the clips are for, where their files do not hold it")
      ->type_name("FILE");
  app.add_option("--to", to, "the character that gets them: asset or source file")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", output, "asset to write: the character with the clips")
      ->required()
      ->type_name("FILE");
  app.add_option("--clip", names, "clips to take, by name")->type_name("NAME")->default_str("all");
  app.add_option("--time", time, "keep, or froude: larger bodies move more slowly, as pendulums do")
      ->check(CLI::IsMember({"keep", "froude"}))
      ->capture_default_str();
  app.add_option("--map", map_file, "joints whose names do not say what they are, JSON")->type_name("FILE");
  app.add_flag("--keep-clips", keep, "the character's own clips stay beside them");
  app.add_flag("--no-plant", no_plant, "leave soles as high and as far as the proportions put them");
  app.add_option("--report", report_file, "write the report as JSON")->type_name("FILE");
  app.add_flag("--json", json, "report on standard output as JSON");
}

Error RetargetCommand::run() const {
  std::vector<std::string> inputs = clips;
  inputs.insert(inputs.end(), {from, to, map_file});
  if (Error error = check_outputs({output, report_file}, inputs)) return error;
  retarget::Options options;
  options.clips = names;
  options.froude = time == "froude";
  options.plant = !no_plant;
  options.keep_clips = keep;
  if (!map_file.empty()) {
    nlohmann::json map;
    if (Error error = read_json(map_file, map)) return error;
    if (Error error = options.read_map(map)) return {map_file + ": " + error.message};
  }
  Asset character;
  nlohmann::json ignored, all = nlohmann::json::array();
  if (Error error = convert::open_any(to, nlohmann::json::object(), character, ignored)) return error;
  std::vector<std::pair<std::string, Asset>> sources;
  if (Error error = read_sources(*this, sources)) return error;
  for (const auto& [path, source] : sources) {
    nlohmann::json report;
    if (Error error = retarget::retarget_clips(source, character, options, character, report))
      return {path + " to " + to + ": " + error.message};
    options.keep_clips = true;
    report["source"] = path;
    if (!json) say("%s -> %s: %s", path.c_str(), to.c_str(), retarget::report_text(report).c_str());
    all.push_back(std::move(report));
  }
  const std::vector<std::uint8_t> bytes = write_asset(character);
  if (Error error = write_atomically(output, bytes.data(), bytes.size())) return error;
  const nlohmann::json report = {{"output", output}, {"target", to}, {"sources", all}};
  if (!report_file.empty())
    if (Error error = write_atomically(report_file, json_text(report, 2) + "\n")) return error;
  if (json)
    std::puts(json_text(report).c_str());
  else
    say("%s: %zu bytes\n", output.c_str(), bytes.size());
  return {};
}

}  // namespace sinew::cli
