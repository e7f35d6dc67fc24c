// Least-squares fits of uniform B-splines to samples.
#pragma once

#include <Eigen/Sparse>
#include <span>

namespace sinew::convert {

/// The basis of one number of spans at the instants of the samples, factorised once for all curves on it.
class KnotGrid {
 public:
  /// `instants`: [frame] of the samples, 0 to 1; after the last of a loop comes, at 1, the first again.
  KnotGrid(std::span<const double> instants, int spans, int degree, bool loops);

  /// Controls [control][component] of the curve that lies nearest to the samples [frame][component].
  Eigen::MatrixXd fit(const Eigen::MatrixXd& samples) const;
  /// The curve at the samples' instants, [frame][component].
  Eigen::MatrixXd evaluate(const Eigen::MatrixXd& controls) const;
  /// Its second derivative there, per knot interval squared.
  Eigen::MatrixXd evaluate_second(const Eigen::MatrixXd& controls) const { return second_ * controls; }
  int controls() const { return controls_; }
  int spans() const { return spans_; }
  int degree() const { return degree_; }

 private:
  int spans_ = 0, controls_ = 0, degree_ = 0;
  Eigen::SparseMatrix<double> basis_, second_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

/// How far independent errors of ±½ of the controls shake the curve's second derivative, root mean square,
/// for knots one unit apart.
double second_derivative_noise(int degree);

}  // namespace sinew::convert
