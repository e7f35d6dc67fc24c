// One joint's rotation or translation as a curve of few controls with few bits.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "convert/fit/chain_error.h"
#include "convert/fit/knot_grid.h"
#include "sinew/animation/clip.h"

namespace sinew::convert {

/// What a curve has to follow, and the curve.
class FittedTrack {
 public:
  /// Rotations take signs that follow each other, and a reference in the middle of what they reach.
  FittedTrack(int joint, bool rotation, const JointMotion& motion);

  /// Fits controls on a grid, without rounding.
  void fit(const KnotGrid& grid);
  /// Accelerations of the curve that `fit` would find, at the samples [frame][component]:
  /// m/s² or, of a rotation, rad/s² but for terms of second order. `interval`: s between knots.
  Eigen::MatrixXd accelerations(const KnotGrid& grid, double interval) const;
  /// Rounds them; `step` is an index of packing_step().
  void round(const KnotGrid& grid, int step);

  int joint() const { return joint_; }
  bool rotation() const { return rotation_; }
  int step() const { return packing_.step; }
  const Clip::Packing& packing() const { return packing_; }
  /// Bits of all its numbers.
  double bits() const { return bits_; }
  /// Whether rounding has left it any motion.
  bool moves() const { return moves_; }
  int controls() const { return static_cast<int>(numbers_.rows()); }
  /// Appends control number `index` as samplers take it.
  void append_control(int index, std::vector<float>& out) const;
  /// All controls that `fit` would find on a grid, as samplers take them, without rounding: [control].
  std::vector<Eigen::Vector4f> smooth_controls(const KnotGrid& grid) const;
  /// What the curve is at a sample: as rounded, or as it would be without rounding.
  void play(int frame, Transform<double>& out) const { value(rounded_, frame, out); }
  void play_unrounded(int frame, Transform<double>& out) const { value(smooth_, frame, out); }
  /// Finest step that its packing can hold.
  int finest_step() const { return finest_step_; }

 private:
  void value(const Eigen::MatrixXd& curve, int frame, Transform<double>& out) const;

  int joint_ = 0;
  bool rotation_ = true;
  int finest_step_ = 0;
  double bits_ = 0;
  bool moves_ = false;
  Clip::Packing packing_;
  Quat<double> reference_ = Quat<double>::Identity();  ///< packing_'s, of any length
  Eigen::MatrixXd samples_;                            ///< [frame][component]
  Eigen::MatrixXd smooth_, rounded_;                   ///< the curves at the samples
  Eigen::MatrixXd controls_;                           ///< unrounded
  Eigen::MatrixXi numbers_;                            ///< [control][component]
};

/// Whether it takes a curve at all: rad and m from the first sample.
double largest_turn(const JointMotion& motion);
double largest_shift(const JointMotion& motion);

}  // namespace sinew::convert
