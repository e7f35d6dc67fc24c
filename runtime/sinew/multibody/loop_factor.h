// Least squares with the columns of Φ_q that belong to the dependent coordinates: by an orthogonal
// factorisation, or by the small Cholesky factor of ΦᵀΦ that the paper uses (section 3.2), which costs a
// fraction and loses half the digits.
#pragma once

#include <Eigen/Dense>

#include "sinew/multibody/motion.h"

namespace sinew::multibody {

class LoopFactor {
 public:
  /// Relative singular value below which the loops are taken to say nothing: a position error of 1e-10 m then
  /// moves the dependent coordinates by less than 1e-3.
  static constexpr double kSingular = 1e-7;

  enum class Kind {
    kOrthogonal,
    kNormal,  ///< Cholesky; orthogonal where the smallest pivot is below kWorstNormal of the largest
  };

  void resize(Eigen::Index rows, Eigen::Index columns);
  void compute(const Matrix& a, Kind kind);
  /// argmin |a·x − b|, for one column or many.
  template <class B>
  auto solve(const B& b) const {
    using Solution = Eigen::Matrix<double, Eigen::Dynamic, B::ColsAtCompileTime>;
    return normal_ ? Solution(cholesky_.solve(a_.transpose() * b)) : Solution(orthogonal_.solve(b));
  }
  /// Smallest over largest pivot, about that of singular values; 1 without columns.
  double conditioning() const { return conditioning_; }

 private:
  /// Squaring leaves 1e-16/kWorstNormal² = 1e-10 there.
  static constexpr double kWorstNormal = 1e-3;

  Matrix a_, product_;
  Eigen::LLT<Matrix> cholesky_;
  Eigen::CompleteOrthogonalDecomposition<Matrix> orthogonal_;
  double conditioning_ = 1;
  bool normal_ = false;
};

}  // namespace sinew::multibody
