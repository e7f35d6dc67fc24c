#include "convert/fit/knot_grid.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sinew/animation/bspline.h"

namespace sinew::convert {
namespace {

constexpr double kSmoothing = 1e-9;  ///< settles the controls that no sample determines

/// Squares of third differences of the controls, which a smooth curve has few of.
Eigen::SparseMatrix<double> roughness(int controls, bool loops) {
  std::vector<Eigen::Triplet<double>> third;
  const int differences = loops ? controls : controls - 3;
  for (int i = 0; i < differences; ++i) {
    constexpr double stencil[4] = {-1, 3, -3, 1};
    for (int a = 0; a < 4; ++a) third.emplace_back(i, (i + a) % controls, stencil[a]);
  }
  Eigen::SparseMatrix<double> rough(differences, controls);
  rough.setFromTriplets(third.begin(), third.end());
  return rough.transpose() * rough;
}

}  // namespace

KnotGrid::KnotGrid(std::span<const double> instants, int spans, int degree, bool loops)
    : spans_(loops ? std::max(spans, degree + 1) : std::max(1, spans)), degree_(degree) {
  const int frames = static_cast<int>(instants.size());
  controls_ = loops ? spans_ : spans_ + degree;
  std::vector<Eigen::Triplet<double>> entries, second;
  for (int f = 0; f < frames; ++f) {
    const double knots = instants[f] * spans_;
    const int span = std::min(static_cast<int>(knots), spans_ - 1);
    const auto w = BsplineBasis<double>::at(degree, knots - span);
    for (int j = 0; j <= degree; ++j) {
      entries.emplace_back(f, (span + j) % controls_, w.value[j]);
      second.emplace_back(f, (span + j) % controls_, w.second[j]);
    }
  }
  basis_.resize(frames, controls_);
  second_.resize(frames, controls_);
  second_.setFromTriplets(second.begin(), second.end());
  basis_.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> normal = basis_.transpose() * basis_;
  normal += kSmoothing * roughness(controls_, loops);
  solver_.compute(normal);
}

Eigen::MatrixXd KnotGrid::fit(const Eigen::MatrixXd& samples) const {
  return solver_.solve(basis_.transpose() * samples);
}

Eigen::MatrixXd KnotGrid::evaluate(const Eigen::MatrixXd& controls) const {
  return basis_ * controls;
}

double second_derivative_noise(int degree) {
  constexpr int kInstants = 64;
  double squares = 0;
  for (int n = 0; n < kInstants; ++n)
    for (const double w : BsplineBasis<double>::at(degree, (n + 0.5) / kInstants).second) squares += w * w;
  return std::sqrt(squares / kInstants / 12);
}

}  // namespace sinew::convert
