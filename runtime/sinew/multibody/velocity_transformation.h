// The second velocity transformation q' = Rz·q'_i of a closed mechanism: which coordinates are independent,
// and how the others follow (equations 37–46).
//
// The independent coordinates come from a pivoted factorisation of the loop Jacobian Φ_q. The others are
// found from the loops by least squares, so redundant equations (Bricard: 5 of rank 4) do no harm, and with
// small singular values cut off, so that a mechanism passing through a singular position keeps what the
// integrator predicts for the directions that the loops leave undetermined there. Least squares are solved by
// orthogonal factorisation, or as the paper does by normal equations (loop_factor.h): half the digits are
// lost by squaring.
#pragma once

#include "sinew/multibody/loop_closure.h"
#include "sinew/multibody/loop_factor.h"

namespace sinew::multibody {

class VelocityTransformation {
 public:
  /// Value of `weakest` below which rounding is felt in accelerations: loops are closed to rounding there.
  static constexpr double kWeak = 1e-2;

  VelocityTransformation(const Model& model, LoopFactor::Kind kind);

  const std::vector<int>& independent() const { return independent_; }
  const std::vector<int>& dependent() const { return dependent_; }
  int freedom() const { return static_cast<int>(independent_.size()); }
  bool trivial() const { return dependent_.empty(); }
  /// ∂q_d/∂q_i [dependent×independent].
  const Matrix& dependent_rates() const { return rates_; }

  /// Chooses independent coordinates at the poses of `motion`: those that leave the dependent ones best
  /// determined. True when the choice differs from the present one.
  bool choose(const BodyMotion& motion);
  /// How badly determined the dependent coordinates are: largest |∂q_d/∂q_i|.
  double growth() const { return trivial() ? 0 : rates_.cwiseAbs().maxCoeff(); }

  /// Smallest over largest singular value (by pivots) with which the loops determine the dependent
  /// coordinates; 0 at a singular position.
  double weakest() const { return factor_.conditioning(); }

  /// Solves the loops for the dependent coordinates of q by Newton from where they are; sets the poses of
  /// `motion` and factorises Φ_q there. False when the loops cannot be closed from here.
  /// Closed means |Φ| ≤ `tolerance` (m).
  bool close_positions(Eigen::Ref<Vector> q, BodyMotion& motion, double tolerance);
  /// Factorises Φ_q at the poses of `motion` without closing the loops there: index 2.
  void linearise(const BodyMotion& motion);
  /// Dependent rates (or directions of motion) q'_d = ∂q_d/∂q_i·q'_i, by the transformation of the last
  /// place.
  void follow(Eigen::Ref<Vector> qd) const;
  /// Replaces the dependent rates by what the independent ones imply.
  void close_rates(Eigen::Ref<Vector> qd) const;
  /// Dependent accelerations at zero independent ones (equation 38): poses and rates must be set; fills
  /// `bias` [N] with zeros for the independent coordinates and overwrites the accelerations of `motion`.
  void bias(BodyMotion& motion, Vector& bias);

  /// q'' = Rz·(independent part of qdd) + bias, in place.
  void expand(const Vector& bias, Eigen::Ref<Vector> qdd) const;
  /// Rzᵀ·force [independent].
  void reduce(const Vector& force, Vector& out) const;
  /// Rzᵀ·A·Rz [independent×independent].
  void reduce(const Matrix& a, Matrix& out) const;

  /// Loops' errors at the poses of `motion`.
  Gap gap(const BodyMotion& motion);

 private:
  void split(const Matrix& jacobian);

  const Model* model_;
  LoopFactor::Kind kind_;
  std::vector<int> independent_, dependent_;
  Matrix jacobian_, by_dependent_, by_independent_, rates_;
  LoopFactor factor_;
  Vector phi_, zero_;
};

}  // namespace sinew::multibody
