// Conversion options: one JSON object, every key documented by reference_options().
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "convert/convert.h"

namespace sinew::convert {

struct Options {
  double unit = 0;               ///< m per source unit; 0: from the file, else guessed
  std::string up;                ///< "x", "y", "z"; empty: from the file, else guessed
  double total_mass = 0;         ///< kg; 0: from the height
  double strength = 1;           ///< scales all muscle limits
  double strength_margin = 1.5;  ///< muscles are at least this much stronger than the clips ask
  bool simulate_fingers = false;
  bool free_base = true;  ///< URDF: the root link may move
  bool strict = false;    ///< refuse instead of repairing
  double fit_error_mm = 1;
  int fit_degree = 5;
  std::vector<std::string> clips;  ///< names to keep; empty: all

  /// Unknown keys and wrong types are an error that names the key.
  static Error parse(const nlohmann::json& json, Options& out);
};

}  // namespace sinew::convert
