// Source files → runtime asset: clean-up, units, physical body, clip fitting, report.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "import/source_scene.h"
#include "sinew/io/asset.h"

namespace sinew::convert {

/// Outcome of a tools-side call: empty message means it worked; otherwise one line "FILE: what is wrong
/// (where)".
struct Error {
  std::string message;
  explicit operator bool() const { return !message.empty(); }
};

struct Options;

/// Fits the clips of a file that holds another skeleton to a character, which gains them; `report` is the
/// conversion's. Given from outside: retargeting builds on conversion (retarget/retarget.h has one).
using AddForeignClips = std::function<Error(const std::string& input, const Options& options,
                                            Asset& character, nlohmann::json& report)>;

/// Converts one or more source files (mesh and clips may come from several) into an asset.
/// `options` overrides the defaults that `reference_options()` documents; unknown keys are an error.
/// `report` receives what was decided, as JSON (also stored in the asset).
/// Files whose clips are for another skeleton are an error, or with option `retarget` given to `add_foreign`.
Error convert_files(const std::vector<std::string>& inputs, const nlohmann::json& options, Asset& out,
                    nlohmann::json& report, const AddForeignClips& add_foreign = {});

/// Where what clips say beside their motion stands for a source: walk.fbx → walk.clips.json.
std::string clip_data_beside(const std::string& input);

/// All options with defaults and comments, as JSON with // comments (nlohmann parses it with
/// ignore_comments).
std::string reference_options();

/// Loads a .sinew asset or converts a source file on the fly, by magic bytes. Used by info, evaluate and
/// render.
Error open_any(const std::string& path, const nlohmann::json& options, Asset& out, nlohmann::json& report);

}  // namespace sinew::convert
