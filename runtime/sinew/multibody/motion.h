// Root → leaves: positions, velocities Z and accelerations Z' of the bodies of a mechanism (equations 2–4).
//
// Z of a body is its velocity field given by (omega, velocity): angular velocity and the velocity of the
// material point that is at the common origin (the world's). Then Z_i = Z_parent + b_i q'_i and
// Z'_i = Z'_parent + b_i q''_i + d_i, plain sums, with b the motion axes of runtime/sinew/residual (w, v).
// Z' is the time derivative of the field at the fixed origin, so d_i = Z_parent × b_i q'_i; the paper's
// derivative follows the material point, which only moves the term ω × v from Q to d.
#pragma once

#include <span>

#include "sinew/multibody/model.h"

namespace sinew::multibody {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using ConstVector = Eigen::Ref<const Vector>;

/// Where the bodies are and how they move; all in world axes about the world's origin.
struct BodyMotion {
  Kinematics<double> pose;
  std::vector<Vec3<double>> omega, velocity;      ///< Z
  std::vector<Vec3<double>> drift_w, drift_v;     ///< d
  std::vector<Vec3<double>> alpha, acceleration;  ///< Z', without gravity

  explicit BodyMotion(const Model& model);
};

/// Poses and motion axes at the coordinates q [N] (rad or m). O(N).
void move_to(const Model& model, const ConstVector& q, BodyMotion& motion);
/// Z and d at the rates qd [N]; poses must be there.
void set_rates(const Model& model, const ConstVector& qd, BodyMotion& motion);
/// Z' at the accelerations qdd [N]; poses and rates must be there.
void accelerate(const Model& model, const ConstVector& qdd, BodyMotion& motion);

/// World position (m), velocity and acceleration of a body-fixed point.
Vec3<double> position_of(const BodyMotion& motion, const BodyPoint& point);
Vec3<double> velocity_at(const BodyMotion& motion, int body, const Vec3<double>& position);
Vec3<double> acceleration_at(const BodyMotion& motion, int body, const Vec3<double>& position);

/// ∂(position)/∂q_k of a point at `position` that coordinate k moves.
inline Vec3<double> moved_by(const BodyMotion& m, int k, const Vec3<double>& position) {
  return m.pose.v[k] + m.pose.w[k].cross(position);
}
/// ∂(velocity)/∂q_k at constant rates of a point of velocity `velocity` that coordinate k moves.
Vec3<double> velocity_moved_by(const Model& model, const BodyMotion& motion, int k,
                               const Vec3<double>& position, const Vec3<double>& velocity);

}  // namespace sinew::multibody
