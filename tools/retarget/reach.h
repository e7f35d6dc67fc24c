// Legs and arms that reach a goal, within what their middle joint can do.
#pragma once

#include <span>

#include "retarget/pose_map.h"

namespace sinew::retarget {

/// A leg or an arm of the target.
struct Limb {
  Role upper = Role::kNone, middle = Role::kNone, end = Role::kNone;
  bool leg = false;
};

/// Both legs, both arms.
extern const Limb kLimbs[4];

/// Solves a limb: two bones, as TwoBoneJob does it.
class Reach {
 public:
  /// The limb's chains must be there.
  Reach(const PoseMap& map, const Limb& limb);

  /// From the upper joint to the end, m: what the limb reaches with its middle joint within its range, a
  /// little bent.
  double longest() const { return longest_; }
  /// What it comes down to, folded, m.
  double shortest() const { return shortest_; }

  /// Learns from a motion in which plane the limb bends, as a direction in the upper joint's axes: the mean
  /// over all frames, those that bend most counting most. A plane from each frame alone would be noise where
  /// the limb is all but straight, and the wrong side where a captured knee goes through.
  void learn_plane(const std::vector<std::vector<Transform<double>>>& local);

  /// Moves the end joint to `goal` (m, model), which keeps its orientation; the middle joint bends as a hinge
  /// where it is one, in the plane that was learnt, to the share `learnt`, else in the animation's. False
  /// where no plane can be found: the pose stays.
  bool solve(const Vec3<double>& goal, double learnt, std::span<Transform<double>> local) const;

 private:
  double reach_at(double angle) const;
  void find_range();
  /// The middle joint's turn about its hinge alone, within its range.
  void turn_as_hinge(Transform<double>& local) const;

  const PoseMap& map_;
  int upper_, middle_, end_;
  std::vector<int> parents_;
  Vec3<double> pole_;  ///< to which the middle joint points, upper joint's axes
  double length_ = 0;  ///< of both bones
  double shortest_ = 0, longest_ = 0;
};

/// Largest angle by which a revolute joint is beyond its range in a pose, rad; negative within.
double beyond_range(const Joint& joint, const Quat<double>& local);

}  // namespace sinew::retarget
