// A judge of recorded scenes. It knows shapes, masses and poses, nothing of how they came about: its geometry
// is the studies' own (audit/) and shares no code with the runtime.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "scene/recording.h"
#include "study/audit/member.h"

namespace sinew::study {

class Judge {
 public:
  explicit Judge(const scene::Recording& recording);

  int frames() const { return static_cast<int>(recording_.frames.size()); }
  int frame_at(double seconds) const;
  /// m, deepest in the floor or an obstacle: all of a frame, or one member (characters, then props).
  double depth_in_surroundings(int frame, int member = -1) const;
  /// m, deepest that two members lie in each other.
  double depth_between(int frame) const;
  double depth_between(int frame, int a, int b) const;
  /// m, at least so far is a member from all others.
  double distance_from_others(int frame, int member) const;
  /// m, widest that a joint without translations stands open.
  double joint_gap(int frame) const;
  /// m/s, of the fastest centre of mass of any body, over the step that ended with the frame.
  double fastest(int frame, int member = -1) const;
  /// J, over the same step.
  double kinetic(int frame, int member) const;
  Eigen::Vector3d center_of_mass(int frame, int member) const;
  Eigen::Vector3d velocity(int frame, int member) const;  ///< of the centre of mass, m/s
  bool finite(int frame) const;

  /// The worst over frames first to last.
  template <class Of>
  double worst(int first, int last, Of of) const {
    double most = 0;
    for (int f = first; f <= last; ++f) most = std::max(most, of(f));
    return most;
  }
  int members() const { return static_cast<int>(members_.size()); }
  double step() const { return 1 / recording_.frame_rate; }

 private:
  std::vector<Transform<double>> poses(int frame, int member) const;

  const scene::Recording& recording_;
  std::vector<audit::Member> members_;
  audit::Surroundings around_;
};

/// m, furthest that any joint or prop of a member of one recording is from where it is in another.
double apart(const scene::Recording& a, int member_a, const scene::Recording& b, int member_b, int frame);

}  // namespace sinew::study
