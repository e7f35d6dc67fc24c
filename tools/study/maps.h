// Failure maps: which steps an engine survives, over joint speed and over mass ratio.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/engine.h"

namespace sinew::study {

enum class Fate { kFaithful, kLoses, kGains, kExplodes, kCannot };

/// One cell: worst of some seeds.
struct MapCell {
  Fate fate = Fate::kFaithful;
  double energy = 0;  ///< change to the end, or the largest gain, over the energy that moves in the scene
};

struct FailureMap {
  std::string title, across, change;  ///< names of the picture, its x axis, and what energies are divided by
  std::vector<double> steps{1.0 / 240, 1.0 / 120, 1.0 / 60, 1.0 / 30, 1.0 / 15};  ///< s
  std::vector<double> columns{};                                                  ///< rad/s or mass ratio
  std::vector<EngineOption> engines{};
  std::vector<MapCell> cells{};  ///< [engine][step][column]

  const MapCell& cell(std::size_t engine, std::size_t step, std::size_t column) const {
    return cells[(engine * steps.size() + step) * columns.size() + column];
  }
};

/// Free flight of the 37-DOF figure without gravity and friction for 1 s; rms joint speed in rad/s.
MapCell fate_of_flight(const EngineOption& engine, double h, double speed, int seeds);
/// A hinged chain of five links let go horizontally; mass of the last link over the first.
MapCell fate_of_chain(const EngineOption& engine, double h, double ratio, double seconds);

/// `quick`: one seed and half the time. `progress(done, total)` may be empty.
FailureMap map_of_speeds(bool quick, const std::function<void(int, int)>& progress);
FailureMap map_of_masses(bool quick, const std::function<void(int, int)>& progress);

std::string map_csv(const FailureMap& map);
/// As a picture in a light theme, .png or .svg by the ending.
convert::Error draw_map(const FailureMap& map, const std::string& file);

}  // namespace sinew::study
