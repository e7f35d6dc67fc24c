#include "sinew/skeleton/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace sinew {

PrincipalAxes principal_axes(const Mat3<double>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace sinew
