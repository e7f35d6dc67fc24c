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
};

struct FitOptions {
  double max_error_mm = 1;  ///< at a virtual vertex 10 cm from the joint
  double still_mm = 0.1;    ///< translations that move less are constants
  int degree = 5;           ///< 5 for motion capture: smooth accelerations from noisy keys; 3 for clean keys
  int coarsest = 2;         ///< frames per knot to try first; halved until the error fits
};

struct FitReport {
  struct Joint {
    double max_mm = 0, rms_mm = 0;
  };
  std::vector<Joint> joints;
  double max_mm = 0, rms_mm = 0;
};

/// Least squares on sign-aligned quaternions in R⁴ and on translations, per joint with the coarsest knots
/// that keep the error in bounds; one knot per frame interpolates. Joints that do not move become constants.
/// Cost: one sparse factorisation per knot spacing, one solve per component and joint.
Clip fit_clip(const FitInput& input, const FitOptions& options, FitReport& report);

}  // namespace sinew::convert
