// What accuracy costs in time: the settings of a step.
#pragma once

#include <cstdint>

namespace sinew {

/// How inertia is carried across a step (DESIGN of the incremental potential: runtime/README.md).
enum class Scheme : std::uint8_t {
  kMomentum,  ///< the seed talk's literal residual M₁V₁ − M₀V₀ − F·h, angular velocity the finite rotation
              ///< over the step: no energy, so no descent to fall back on; splits where Newton fails
  kBdf1,  ///< implicit Euler: first order, damps; true after a change of contacts
  kBdf2,  ///< second order, torque-free rotation prediction; falls back to bdf1 while the contact set changes
  kBossak,  ///< the default: second order through changes of contact, from one step back (bossak.h)
};

/// Lengths in metres, angles in radians, speeds in m/s.
struct Accuracy {
  Scheme scheme = Scheme::kBossak;
  double tolerance = 3e-5;  ///< stop when the last correction moves no body by more (m)
  int max_iterations = 60;  ///< outer passes; the mean is 1.7, hard impacts at 1/30 s need the tail
  int substeps = 1;         ///< every step in so many equal parts
  int start_parts = 4;      ///< a step from a reset, which bdf2 has no history for, is cut into parts that
                            ///< double, where something is near or acts; in flight it is taken whole
  double max_rotation = 0;  ///< rad; more substeps where a body would turn further in one. 0: never
  double impact_step =
      1.0 / 60;              ///< s; a longer step in which a limp body strikes something is halved. 0: never
  int max_splits = 3;        ///< an unconverged step is halved, and its halves, so often
  double sink_depth = 5e-4;  ///< how deep one contact point sinks under the character's weight (m)
  double contact_damping = 0.5;   ///< of surfaces; 1 is critical for the character's weight on one point
  double stick_speed = 0.005;     ///< slip speed below which friction sticks (m/s)
  double limit_stiffness = 2000;  ///< joint limits, N·m/rad
  double limit_damping = 0.02;    ///< joint limits: s; their torque is that of the angle so much later
  double return_time = 0.1;       ///< time constant of the way back to the animation (s)
  bool estimate_error =
      false;  ///< fill CharacterReport::estimated_error (error_estimate.h says what it costs)
};

}  // namespace sinew
