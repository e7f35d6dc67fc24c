// Assets, clips and what characters did in a scene → files of other tools.
#pragma once

#include <string>
#include <vector>

#include "export/gltf.h"
#include "scene/scene.h"

namespace sinew::cli {

struct Export {
  std::string output;              ///< its ending says what it is
  std::vector<std::string> clips;  ///< names; none: all
  double rate = 60;                ///< keys per second
  bool cubic = false;
  exporting::Surface surface = exporting::Surface::kSkin;
  bool rate_asked = false, surface_asked = false;  ///< by the user, who is told where they mean nothing
  std::string character;                           ///< of a scene, by name; empty: all

  /// Why the output cannot be made, asked before any work is done for it.
  convert::Error check() const;
};

/// Writes an asset with its clips. `report` says what is in the file, and in `notes` what could not be.
convert::Error export_asset(const Asset& asset, const Export& what, nlohmann::json& report);

/// Plays a scene and writes what its characters did.
convert::Error export_scene(const scene::Scene& scene, const Export& what, nlohmann::json& report);

/// The report as text for a person.
std::string export_text(const nlohmann::json& report);

}  // namespace sinew::cli
