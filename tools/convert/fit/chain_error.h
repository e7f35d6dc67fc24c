// How far a skin point moves when the joints' curves are not quite the source's motion.
#pragma once

#include <span>
#include <vector>

#include "sinew/skeleton/transform.h"

namespace sinew::convert {

/// Local transforms of one joint, [frame].
using JointMotion = std::vector<Transform<double>>;

/// Compares a motion with a reference along the whole chain: errors of a joint's ancestors count as its own.
/// The error of a joint at a frame is the largest displacement in model space of three points at `distance`
/// from it, one on each of its axes: virtual points of a skin.
class ChainError {
 public:
  /// `parents`: [joint], −1 for none, parents before children; empty: joints for themselves.
  /// `reference`: [frame][joint].
  ChainError(const std::vector<std::vector<Transform<double>>>& reference, std::vector<int> parents,
             double distance);

  int frames() const { return frames_; }
  int joints() const { return static_cast<int>(truth_.size()); }
  int parent(int joint) const { return parents_[joint]; }
  /// Of the reference: in model space, and relative to the parent.
  const Transform<double>& model(int joint, int frame) const { return truth_model_[joint][frame]; }
  const Transform<double>& truth(int joint, int frame) const { return truth_[joint][frame]; }

  /// The motion of one joint as it is played.
  void set(int joint, JointMotion local);
  /// Recomputes what `joint` and its descendants are off by. Cost: frames × descendants.
  void update(int joint);
  void update();  ///< all joints
  /// m; of the state at the last update.
  double error(int joint, int frame) const { return error_[joint][frame]; }
  int worst_frame(int joint) const;
  double largest() const;
  double rms(int joint) const;
  double rms() const;
  /// Whether a joint lies on the chain of another.
  bool is_above(int joint, int other) const;

 private:
  void compare(int joint);

  int frames_ = 0;
  double distance_ = 0;
  std::vector<int> parents_;
  std::vector<JointMotion> truth_, truth_model_, local_, model_;  ///< [joint][frame]
  std::vector<std::vector<double>> error_;                        ///< [joint][frame]
};

}  // namespace sinew::convert
