// Bodies by Cartesian coordinates of their own: where each centre of mass is, how the body is turned (Euler
// parameters), and how fast both change. What global formulations integrate (Haug, "Computer Aided Kinematics
// and Dynamics of Mechanical Systems", 1989, chapters 9 and 11; ADAMS and DADS work so).
//
// State y [13·bodies]: centres (m) and Euler parameters (w, x, y, z), 7 per body; then velocities of the
// centres (m/s) and angular velocities (rad/s), 6 per body; all in world axes.
#pragma once

#include <Eigen/Geometry>

#include "sinew/multibody/force_elements.h"

namespace sinew::study {

/// Force (N) and moment about the centre of mass (N·m) of every body, [6·bodies].
using Wrenches = multibody::Vector;

class CartesianMotion {
 public:
  explicit CartesianMotion(const multibody::Model& model);

  int bodies() const { return model_->size(); }
  const multibody::Model& model() const { return *model_; }
  const multibody::BodyMotion& motion() const { return motion_; }
  const multibody::Vector& joint_positions() const { return q_; }
  const multibody::Vector& joint_rates() const { return qd_; }

  /// State of the bodies at joint coordinates and rates y [2N].
  multibody::Vector from_joints(const multibody::Vector& y);
  /// Takes over a state. False where it is not finite. Angles of joints are those nearest to the last ones.
  bool set(const multibody::Vector& state);
  /// Moves the body by so much along a coordinate (0–2: along an axis, 3–5: turn about one), or changes that
  /// velocity; until the next `set`.
  void move(int body, int coordinate, double by);
  void speed_up(int body, int coordinate, double by);
  /// Joint coordinates after moves.
  void refresh_joints();

  /// Rates of the positions of a state [7·bodies] at velocities v [6·bodies].
  void position_rates(const multibody::Vector& state, const multibody::ConstVector& v,
                      Eigen::Ref<multibody::Vector> out) const;
  /// What a change of positions [7·bodies] is as a small translation and turn [6·bodies]: the inverse.
  multibody::Vector turns_of(const multibody::Vector& state, const multibody::ConstVector& change) const;

  /// Applied forces, gravity and gyroscopic moments.
  void wrenches(double t, Wrenches& out);
  /// Inertia about the centre of mass in world axes.
  Mat3<double> inertia(int body) const;

 private:
  void derive(int body);

  const multibody::Model* model_;
  multibody::BodyMotion motion_;
  std::vector<Vec3<double>> speed_;  ///< of the centres
  multibody::AppliedForces applied_;
  multibody::Vector q_, qd_;
};

}  // namespace sinew::study
