// What a peer's joint motors are asked for: the way that our muscles take. Each engine enforces it with its
// own documented motor constraint, a velocity and the most torque that may be spent on it.
#pragma once

#include "study/engine.h"

namespace sinew::study {

class Servo {
 public:
  explicit Servo(const Figure& figure)
      : before_(figure.jets), wanted_(figure.jets), offset_(figure.jets.size(), Vec3<double>::Zero()) {}

  /// Of the end of the next step.
  void aim(const std::vector<JointJet<double>>& jets) { wanted_ = jets; }
  /// To be called when all of a step's rates are known.
  void advance() { before_ = wanted_; }

  /// rad/s, child axes, that lead a joint at `now` (child → parent) where it should be after the next step:
  /// back to the animation critically damped, with the time constant of Accuracy::return_time. Once per step
  /// and joint: how fast it strays is taken from where it was a step before, since engines differ in which
  /// axes and instant their velocities mean.
  Vec3<double> rate(int joint, const Quat<double>& now, double h);

  /// Velocities of a driven root's frame that lead from `now` to its target in one step.
  struct Travel {
    Vec3<double> rate;      ///< rad/s, child axes
    Vec3<double> velocity;  ///< m/s, world
  };
  Travel travel(const Transform<double>& now, double h) const;
  const JointJet<double>& target(int joint) const { return wanted_[joint]; }

 private:
  std::vector<JointJet<double>> before_, wanted_;
  std::vector<Vec3<double>> offset_;  ///< [joint] from the animation a step ago, rad, child axes
};

/// A muscle pulls with torques in [−minus, plus], a motor in [−most, most]: the same about a constant torque.
struct Motor {
  Vec3<double> bias, most;  ///< N·m, per degree of freedom
};
Motor motor_of(const Joint& joint);

}  // namespace sinew::study
