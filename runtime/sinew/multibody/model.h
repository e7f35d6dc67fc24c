// A valid mechanism as flat arrays: the runtime's Tree (bodies renumbered in joint order, so body i hangs on
// joint i, which is coordinate i) plus forces and loops with points in body axes.
#pragma once

#include "sinew/multibody/mechanism.h"
#include "sinew/residual/tree.h"

namespace sinew::multibody {

/// Body-fixed point: `local` in the axes of the body, from its joint's origin; world point for the ground.
struct BodyPoint {
  int body = kGround;
  Vec3<double> local = Vec3<double>::Zero();
};

/// The coordinates between two bodies: those that move one and not the other.
struct Path {
  std::vector<int> of_a;  ///< from a up to, not including, the last common ancestor
  std::vector<int> of_b;
};

struct LoopModel {
  LoopType type;
  int first_row;
  BodyPoint a, b;
  Vec3<double> axis_b;       ///< revolute: in body b
  Vec3<double> normal_a[2];  ///< revolute: two directions normal to the axis, in body a
  double length = 0;         ///< distance
  Path path;
};

struct ForceModel {
  Force law;  ///< numbers of the file; its points are not used here
  BodyPoint a, b;
  Vec3<double> direction;  ///< in the axes of the body that it turns with
  Path path;               ///< between body a and body b
};

class Model {
 public:
  /// `mechanism` must have no fault.
  explicit Model(const Mechanism& mechanism);

  const Mechanism& mechanism() const { return mechanism_; }
  int size() const { return tree.bodies; }

  Tree<double> tree;
  std::vector<int> body_of_file;  ///< [body of the file] body here
  std::vector<JointForce> joint_force;
  std::vector<LoopModel> loops;
  std::vector<ForceModel> forces;
  std::vector<BodyPoint> points;
  int loop_rows = 0;
  /// Shortest time over which a prescribed profile changes, s: an integrator that steps further may miss it.
  double shortest_profile = 0;

 private:
  BodyPoint attach(int body_of_file_index, const Vec3<double>& point) const;
  Path path_between(int a, int b) const;
  void note_profile(const std::vector<Pulse>& pulses);

  Mechanism mechanism_;
};

}  // namespace sinew::multibody
