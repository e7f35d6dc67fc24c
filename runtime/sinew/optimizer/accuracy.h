// What accuracy costs in time: the settings of a step.
#pragma once

namespace sinew {

/// Lengths in metres, angles in radians, speeds in m/s. All lengths, times, speeds and stiffnesses are those
/// of a figure of human size; of others they are in proportion to length, mass and weight (residual/scale.h),
/// so that all sizes move alike.
struct Accuracy {
  double tolerance = 3e-5;  ///< stop when the last correction moves no body by more (m)
  int max_iterations =
      60;            ///< outer passes of a solve; the mean is 1.7, hard impacts at 1/30 s need the tail
  int substeps = 1;  ///< every step in so many equal parts
  double max_rotation =
      0.5;  ///< rad; a step in which much of a limp figure turns further is halved. 0: never
  double shortest_part = 1.0 / 240;  ///< s; such halves are not halved below
  int max_splits = 3;                ///< an unconverged step is halved, and its halves, so often
  /// Outer passes of all solves of a substep together, those repeated with it. Beyond, nothing is halved and
  /// each part takes a dozen at most, and its lowest pose. After each step in a row that did not converge
  /// the next one has half as many, where no loop or particle takes part.
  int max_passes = 100;
  double sink_depth = 5e-4;       ///< how deep one contact point sinks under the character's weight (m)
  double contact_damping = 0.5;   ///< of surfaces; 1 is critical for the character's weight on one point
  double stick_speed = 0.005;     ///< slip speed below which friction sticks (m/s)
  double limit_stiffness = 2000;  ///< joint limits, N·m/rad
  double limit_damping = 0.02;    ///< joint limits: s; their torque is that of the angle so much later
  double return_time = 0.1;       ///< time constant of the return to the animation (s)
  bool estimate_error =
      false;  ///< fill CharacterReport::estimated_error (error_estimate.h says what it costs)
};

}  // namespace sinew
