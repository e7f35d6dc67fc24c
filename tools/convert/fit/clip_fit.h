// Sampled motion → B-spline clip.
#pragma once

#include <string>
#include <vector>

#include "sinew/animation/clip.h"

namespace sinew::convert {

struct FitInput {
  std::string name;
  bool loops = false;       ///< first and last sample are the same pose, root aside
  double sample_rate = 30;  ///< Hz
  std::vector<std::vector<Transform<double>>> samples;  ///< [frame][joint] local; at least one frame
  std::vector<int> parents = {};            ///< [joint] before their children, −1 for none; empty: none
  std::vector<Transform<float>> rest = {};  ///< [joint] what joints that keep it need not store; or empty
  std::vector<double> times = {};  ///< [frame] s, rising from 0, where samples are not even; else empty
};

struct FitOptions {
  double max_error_mm = 1;     ///< in model space, of a point of the skin
  double skin_distance = 0.1;  ///< m of that point from its joint
  /// What curves may change accelerations by, root mean square, by coarse knots and by rounding each:
  /// rad/s² of rotations and m/s² of translations, or a share of the curve's own where that is more.
  double angular_acceleration = 0.5, linear_acceleration = 0.1, acceleration_share = 0.02;
  int degree = 5;  ///< 5 for motion capture: smooth accelerations from noisy keys; 3 for clean keys
};

struct FitReport {
  struct Joint {
    double max_mm = 0, rms_mm = 0;  ///< along the chain
  };
  std::vector<Joint> joints;
  double max_mm = 0, rms_mm = 0;
  int worst_joint = 0;    ///< whose error is `max_mm`, and
  double worst_time = 0;  ///< s, when
  /// The same motion without rounding and with fifteen knots a second or more: what accelerations and torques
  /// are to be compared with.
  Clip reference;
};

/// Looks for the curves of fewest bytes that keep a skin point of every joint, its ancestors' errors
/// included, within `max_error_mm` of the samples, and accelerations within their budgets. One knot per
/// sample (of uneven ones per smallest interval) and 16 bits, should nothing less do, come as close as that
/// allows. Each track has a knot spacing
/// and a rounding of its own; what hardly moves is a constant. The report compares the samples with the clip
/// as it is played, but for the last sample of a loop, which is its first.
/// Cost: some hundred passes over all samples; seconds for a clip of a minute.
Clip fit_clip(const FitInput& input, const FitOptions& options, FitReport& report);

}  // namespace sinew::convert
