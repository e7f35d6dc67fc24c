// Motions as files of other tools hold them: poses of all joints at rising times. From a clip, or from what a
// scene's simulation left behind.
#pragma once

#include <string>
#include <vector>

#include "scene/recording.h"

namespace sinew::exporting {

struct Motion {
  std::string name;
  const Clip* clip = nullptr;  ///< of the asset, or none: a simulated result
  std::vector<double> times;   ///< s, rising, from 0
  /// [time][joint] relative to the parent; roots in model space, of a simulated result in the world.
  /// Derivatives are the clip's own; those of a simulated result are not known, and 0.
  std::vector<std::vector<JointJet<double>>> frames;
  std::vector<std::vector<double>> curves = {};  ///< [time][slot of the asset's curves], or empty: at rest
};

enum class Keys {
  kGrid,  ///< at whole multiples of 1/rate, and one at the end
  kEven   ///< at the evenly spaced times that come closest to the rate and hold both ends
};

/// A clip that the asset holds, from its beginning to its end; what lasts no time is one frame.
Motion sample_clip(const Asset& asset, const Clip& clip, double rate, Keys keys);

/// What a character did in a scene: a frame per step.
Motion played_motion(const scene::Recording& recording, int character, const std::string& name);

/// Joint → model space (or world) in a frame.
std::vector<Transform<double>> model_pose(const Skeleton& skeleton,
                                          const std::vector<JointJet<double>>& frame);
/// The same at rest.
std::vector<Transform<double>> rest_pose(const Skeleton& skeleton);

/// Sinew's axes (X forward, Z up) → those of glTF and BVH (Z forward, Y up).
Quat<double> to_y_up();

}  // namespace sinew::exporting
