#include "cli/source_options.h"

#include <filesystem>
#include <utility>

#include "cli/files.h"
#include "convert/options.h"

namespace sinew::cli {

using convert::Error;
using nlohmann::json;

void SourceOptions::add(CLI::App& app) {
  app.add_option("--options", options_file, "conversion options, JSON (see sinew convert --reference)")
      ->type_name("FILE");
  app.add_option("--clip-data", clip_data,
                 "events, curves, markers and masks, JSON (else SOURCE.clips.json, where it is there)")
      ->type_name("FILE");
  app.add_option("--unit", unit, "metres per unit of the source")
      ->check(CLI::PositiveNumber)
      ->default_str("the file's");
  app.add_option("--up", up, "up axis of the source")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->default_str("the file's");
  app.add_option("--facing", facing, "axis of the source that the character faces at rest")
      ->check(CLI::IsMember({"x", "-x", "y", "-y", "z", "-z"}))
      ->default_str("found by its joints");
  app.add_option("--package", packages, "URDF: where a ROS package is, for meshes named package://NAME/…")
      ->type_name("NAME=DIR")
      ->default_str("looked for upwards");
}

std::vector<std::string> SourceOptions::arguments() const {
  std::vector<std::string> all;
  for (const auto& [name, value] :
       {std::pair("--options", options_file), std::pair("--clip-data", clip_data), std::pair("--up", up)})
    if (!value.empty()) all.insert(all.end(), {name, value});
  if (!facing.empty()) all.push_back("--facing=" + facing);             // which may begin with a minus
  if (unit != 0) all.insert(all.end(), {"--unit", json(unit).dump()});  // all digits
  for (const std::string& package : packages) all.insert(all.end(), {"--package", package});
  return all;
}

Error SourceOptions::read(json& out) const {
  out = json::object();
  if (!options_file.empty()) {
    if (Error error = read_json(options_file, out)) return error;
    convert::Options checked;
    if (Error error = convert::Options::parse(out, checked)) return {options_file + ": " + error.message};
  }
  if (!clip_data.empty())
    if (Error error = read_json(clip_data, out["clip_data"])) return error;
  if (unit != 0) out["unit"] = unit;  // NaN too: refused by name
  if (!up.empty()) out["up"] = up;
  if (!facing.empty()) out["facing"] = facing;
  for (const std::string& package : packages) {
    const std::size_t equals = package.find('=');
    if (equals == std::string::npos || equals == 0 ||
        !std::filesystem::is_directory(package.substr(equals + 1)))
      return {"--package " + package + ": not NAME=DIRECTORY of a directory that is there"};
    out["packages"][package.substr(0, equals)] = package.substr(equals + 1);
  }
  return {};
}

}  // namespace sinew::cli
