// A judge of recorded scenes. It knows shapes, masses and poses, nothing of how they came about: its geometry
// is its own and shares no code with the runtime.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "scene/recording.h"

namespace sinew::study {

/// A ball, capsule (segment along its own z) or box where it stands in the world.
struct Solid {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< m: half extents of a box; z: half a capsule's segment
  double radius = 0;                               ///< m; 0 of boxes
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// m, by how much two solids lie in each other; negative: at least so far apart. Exact but for a capsule
/// whose segment goes through a box (the depth of its deepest point) and boxes that are apart.
double overlap(const Solid& a, const Solid& b);
/// m, below a floor at `height`.
double below(const Solid& solid, double height);

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
  struct Body {
    double mass = 0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in its own axes, m
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    int parent = -1;                                   ///< body of the same member that its joint hangs on
    Eigen::Vector3d socket = Eigen::Vector3d::Zero();  ///< in the parent's axes, m
    std::vector<Solid> solids;                         ///< in its own axes
  };
  using Member = std::vector<Body>;

  Eigen::Isometry3d pose(int frame, int member, int body) const;
  std::vector<Solid> placed(int frame, int member) const;

  const scene::Recording& recording_;
  std::vector<Member> members_;
  std::vector<Solid> obstacles_;
};

/// m, furthest that any joint or prop of a member of one recording is from where it is in another.
double apart(const scene::Recording& a, int member_a, const scene::Recording& b, int member_b, int frame);

}  // namespace sinew::study
