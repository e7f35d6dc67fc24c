// DSR: mass matrix and forces in the coordinates by accumulated inertias and forces (equations 22–33).
#pragma once

#include "sinew/multibody/recursive_residual.h"
#include "sinew/residual/tree_factor.h"

namespace sinew::multibody {

/// Accumulated inertia about the world's origin: mass, mass·centre, inertia (all plain sums, equation 31).
struct AccumulatedInertia {
  double mass = 0;
  Vec3<double> moment = Vec3<double>::Zero();
  Mat3<double> inertia = Mat3<double>::Zero();
};

class SemiRecursive {
 public:
  explicit SemiRecursive(const Model& model);
  SemiRecursive(const SemiRecursive&) = delete;
  SemiRecursive& operator=(const SemiRecursive&) = delete;
  /// HᵀMΣH [N×N], symmetric, all entries written. Poses of `motion` must be set.
  void mass_matrix(const BodyMotion& motion, Matrix& mass);
  /// HᵀQΣ [N]: forces on the coordinates at the accelerations that `motion` holds, negated residual.
  void forces(const BodyMotion& motion, const AppliedForces& applied, Eigen::Ref<Vector> out);
  /// Accelerations of an open chain; overwrites those of `motion`. The factor keeps the zeros of (30): the
  /// runtime's own, O(N·depth²).
  void evaluate(BodyMotion& motion, const AppliedForces& applied, Eigen::Ref<Vector> qdd);

 private:
  /// Accumulates the inertias and gives each entry of the lower triangle to `put(row, column, value)`.
  template <class Put>
  void accumulate(const BodyMotion& motion, const Put& put);

  const Model* model_;
  std::vector<AccumulatedInertia> sums_;
  RecursiveResidual residual_;
  TreePattern pattern_;  ///< one unknown per body
  TreeMatrix<double> mass_;
  Vector zero_;
};

}  // namespace sinew::multibody
