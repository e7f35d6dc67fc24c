#include "sinew/multibody/loop_factor.h"

namespace sinew::multibody {

void LoopFactor::resize(Eigen::Index rows, Eigen::Index columns) {
  a_.resize(rows, columns);
  product_.resize(columns, columns);
  orthogonal_ = Eigen::CompleteOrthogonalDecomposition<Matrix>(rows, columns);
  orthogonal_.setThreshold(kSingular);
}

void LoopFactor::compute(const Matrix& a, Kind kind) {
  conditioning_ = 1;
  normal_ = false;
  if (a.cols() == 0) return;
  if (kind == Kind::kNormal) {
    a_ = a;
    product_.noalias() = a_.transpose() * a_;
    cholesky_.compute(product_);
    const auto pivots = cholesky_.matrixLLT().diagonal();
    conditioning_ = pivots.minCoeff() / pivots.maxCoeff();
    normal_ = cholesky_.info() == Eigen::Success && conditioning_ > kWorstNormal;
    if (normal_) return;
  }
  orthogonal_.compute(a);
  const auto pivots = orthogonal_.matrixQTZ().diagonal().cwiseAbs();
  conditioning_ = pivots.minCoeff() / pivots.maxCoeff();
}

}  // namespace sinew::multibody
