// Joints and loops as equations between two bodies' Cartesian coordinates, Φ = 0: each is made of four basic
// ones (Haug 1989, section 9.4): points coincide, a direction of one body is normal to one of the other, or
// to the line between two points, and a distance is kept. Shares no code with the runtime's loops.
#pragma once

#include "study/tables/global/cartesian_motion.h"

namespace sinew::study {

/// One or three equations between body a and body b (kGround: the world).
struct BasicConstraint {
  enum class Kind { kCoincide, kNormal, kNormalToLine, kDistance };
  Kind kind = Kind::kCoincide;
  int first_row = 0;
  multibody::BodyPoint a, b;                                                    ///< not of kNormal
  Vec3<double> along_a = Vec3<double>::Zero(), along_b = Vec3<double>::Zero();  ///< in body axes
  double length = 0;                                                            ///< m

  int rows() const { return kind == Kind::kCoincide ? 3 : 1; }
};

/// Five equations per joint, then those of the loops.
std::vector<BasicConstraint> constraints_of(const multibody::Model& model);

/// A constraint at a state of motion. Derivatives are by translations and turns of the bodies.
struct Linearised {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 3, 6>;
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
  Values gap;       ///< Φ, m or sine of an angle
  Rows by_a, by_b;  ///< ∂Φ/∂(body) [rows×6]; not of the ground
  Values bend;      ///< d²Φ/dt² at zero accelerations of the bodies: −γ
};
Linearised linearise(const BasicConstraint& c, const multibody::BodyMotion& motion);

}  // namespace sinew::study
