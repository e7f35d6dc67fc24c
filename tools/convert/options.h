// Conversion options: one JSON object, every key documented by reference_options().
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "convert/clip_data.h"
#include "convert/convert.h"
#include "convert/human.h"
#include "import/link_meshes.h"

namespace sinew::convert {

/// What the user knows better about one joint.
struct JointOptions {
  std::optional<double> mass;                   ///< kg
  std::optional<std::array<double, 2>> torque;  ///< N·m: largest in the negative and positive direction
  std::optional<std::array<double, 2>> range;   ///< rad, of a hinge
  std::optional<std::array<double, 2>> twist;   ///< rad, of a ball about its bone
  std::optional<double> swing;                  ///< rad, of a ball
  bool ellipsoid = false;                       ///< of a ball: Joint::ellipsoidal_limit
};

struct Options {
  double unit = 0;                             ///< m per source unit; 0: from the file, else guessed
  std::string up;                              ///< "x", "y", "z"; empty: from the file, else guessed
  std::string facing;                          ///< axis of the source that it faces: "z", "-x"; empty: found
  double total_mass = 0;                       ///< kg; 0: from the height
  Human human;                                 ///< whose published strengths and masses
  std::map<std::string, double> muscles;       ///< N·m per kg, replaces rows of `muscle_rows`
  std::map<std::string, JointOptions> joints;  ///< by joint name or role
  double strength = 1;                         ///< scales all muscle limits
  double strength_margin = 1.5;                ///< muscles are at least this much stronger than the clips ask
  bool simulate_fingers = false;
  bool free_base = true;        ///< URDF: the root link may move
  import::Packages packages;    ///< URDF: where ROS packages are, relative to the working directory
  bool retarget = false;        ///< fit clips of other skeletons to this one instead of refusing them
  bool strict = false;          ///< refuse instead of repairing
  double fit_error_mm = 1;      ///< of a skin point, along the chain
  double fit_distance_cm = 10;  ///< of that point from its joint
  double fit_angular = 0.5;     ///< rad/s² that a fitted curve may change a joint's acceleration by, and
  double fit_linear = 0.1;      ///< m/s² of a joint that shifts
  int fit_degree = 5;
  std::vector<std::string> clips;  ///< names to keep; empty: all
  ClipData clip_data;

  /// Unknown keys and wrong types are an error that names the key.
  static Error parse(const nlohmann::json& json, Options& out);
};

/// Gives joints the masses that the options name; the others make up the total (`keep_total`) or stay. An
/// error names a joint that is not simulated or not there.
Error override_masses(const Options& options, bool keep_total, Skeleton& skeleton);

/// Torques, ranges, swings and twists that the options name. Comes last: nothing raises them again.
void override_limits(const Options& options, Skeleton& skeleton);

}  // namespace sinew::convert
