// Whole-model quantities at a state: what `sinew evaluate` prints. Allocates; for tools and tests, not for a
// step.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// State of the simulated joints. Per joint: revolute, prismatic q[0]; universal q[0..1]; planar q[0..2];
/// ball `rotation` from rest; free `rotation` and `position` of the joint frame in its parent (rest ignored).
/// v and a: as JointType says, except that the free joint's are world (parent) axes at the joint's origin:
/// linear, then angular. Ball joints: child axes.
struct JointState {
  double q[3] = {0, 0, 0};
  Quat<double> rotation = Quat<double>::Identity();
  Vec3<double> position = Vec3<double>::Zero();
  double v[6] = {0, 0, 0, 0, 0, 0};
  double a[6] = {0, 0, 0, 0, 0, 0};
};

struct DynamicsResult {
  double total_mass = 0;
  Vec3<double> center_of_mass = Vec3<double>::Zero();
  double kinetic_energy = 0;
  double potential_energy = 0;       ///< −Σ m g·c, zero at the world's origin
  Eigen::VectorXd inverse_dynamics;  ///< torques for (q, v, a)
  Eigen::MatrixXd mass_matrix;
  Eigen::VectorXd forward_dynamics;       ///< accelerations under zero torque
  std::vector<Transform<double>> frames;  ///< [joint] world
};

/// Recursive Newton–Euler for the torques, composite bodies for the mass matrix, its branch-sparse factor for
/// the accelerations. DOFs in joint order, each joint's as JointType says. `states` has body_count entries.
DynamicsResult evaluate_dynamics(const Skeleton& skeleton, const std::vector<JointState>& states,
                                 const Vec3<double>& gravity);

}  // namespace sinew
