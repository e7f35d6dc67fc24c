// Equations that close the loops of the tree: Φ(q) = 0, Φ_q q' = 0, Φ_q q'' = γ (equations 35–38).
#pragma once

#include "sinew/multibody/motion.h"

namespace sinew::multibody {

/// Φ [rows], m (directions of revolute loops: sine of the angle). Poses must be set.
void closure(const Model& model, const BodyMotion& motion, Eigen::Ref<Vector> phi);
/// Φ_q [rows×N]; all entries written.
void closure_jacobian(const Model& model, const BodyMotion& motion, Matrix& jacobian);
/// d²Φ/dt² at the accelerations that `motion` holds; with those at q'' = 0 this is −γ. [rows]
void closure_acceleration(const Model& model, const BodyMotion& motion, Eigen::Ref<Vector> out);

/// Largest |Φ| of each loop's rows: index of the worst loop, and its gap in m (or sine).
struct Gap {
  int loop = -1;
  double size = 0;
};
Gap worst_gap(const Model& model, const Vector& phi);

}  // namespace sinew::multibody
