// RR: the residual of the equations of motion at given accelerations (equations 47–69).
#pragma once

#include "sinew/multibody/force_elements.h"

namespace sinew::multibody {

/// rs_i = b_iᵀ·Σ(M Z' − Q) over the bodies beyond joint i, minus the joint's own force: what joint i would
/// have to exert besides its spring and damper. Zero for the true accelerations. Two passes, O(N); the second
/// is the runtime's project_wrenches.
class RecursiveResidual {
 public:
  explicit RecursiveResidual(const Model& model);
  /// Poses, rates and accelerations of `motion` must be set; `applied` are the forces there.
  void evaluate(const BodyMotion& motion, const AppliedForces& applied, Eigen::Ref<Vector> residual);

 private:
  const Model* model_;
  std::vector<Vec3<double>> force_, moment_;
};

/// Force and moment about the world's origin that body i calls for: M Z' − Q with inertia and gravity in Q
/// (equations 6, 7), referred to the centre of mass (equation 62).
inline void inertial_wrench(const Model& model, const BodyMotion& m, int i, Vec3<double>& force,
                            Vec3<double>& moment) {
  const double mass = model.tree.mass[i];
  if (mass == 0) {
    force.setZero();
    moment.setZero();
    return;
  }
  const Mat3<double>& r = m.pose.rotation[i];
  const Vec3<double>& c = m.pose.center[i];
  force = mass * (acceleration_at(m, i, c) - model.mechanism().gravity);
  const Vec3<double> omega = r.transpose() * m.omega[i], alpha = r.transpose() * m.alpha[i];
  const Mat3<double>& inertia = model.tree.inertia[i];
  moment = r * (inertia * alpha + omega.cross(inertia * omega)) + c.cross(force);
}

}  // namespace sinew::multibody
