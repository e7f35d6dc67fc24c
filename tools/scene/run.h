// Runs a scene: recording for the renderer, telemetry for people and plots.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace sinew::scene {

/// One row per frame and character; the CSV's columns.
struct TelemetryRow {
  double time = 0;
  int character = 0;
  CharacterReport report;
  double microseconds = 0;  ///< of the whole world's step
  int loaded_joint = -1;
  double load = 0, torque = 0, limit = 0;
  double asked = 0;  ///< rad/s², greatest angular acceleration that the animation asks of a joint
  double plotted_torque = 0, plotted_limit = 0;
  std::vector<float> loads;  ///< [simulated joint] largest |torque| / limit
};

struct Telemetry {
  std::vector<TelemetryRow> rows;
  int plotted_joint = -1;
  std::string plotted_name;
};

/// Steps the scene from 0 to its duration. `progress(done, total)` may be empty.
convert::Error run_scene(const Scene& scene, Recording& recording, Telemetry& telemetry,
                         const std::function<void(int, int)>& progress);

std::string telemetry_csv(const Scene& scene, const Telemetry& telemetry);
nlohmann::json telemetry_summary(const Scene& scene, const Telemetry& telemetry);

/// Draws the telemetry with gnuplot to a PNG. Returns an error when gnuplot is missing.
convert::Error plot_telemetry(const std::string& csv_path, const Telemetry& telemetry,
                              const std::string& png_path);

}  // namespace sinew::scene
