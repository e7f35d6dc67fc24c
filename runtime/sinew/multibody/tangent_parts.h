// The parts of ∂F/∂y + c·∂F/∂y' of a mechanism, and Newton's equations solved with them: equations 79, 80, 84
// and 85 with the position rows eliminated, which leaves half the size. c is real for multistep methods; for
// Runge–Kutta methods, whose stages are taken apart by complex numbers, it may be complex.
#pragma once

#include "sinew/multibody/velocity_transformation.h"

namespace sinew::multibody {

/// In independent coordinates.
struct TangentParts {
  Matrix stiffness, damping;  ///< −∂Q/∂q, −∂Q/∂q'
  Matrix inertia;             ///< the mass; the identity where accelerations are compared, not forces
  Matrix stiffness_to_all;    ///< index 2: of the independent forces to all positions [independent×N]
  bool derivatives = false;   ///< F compares accelerations
  bool of_forces = false;     ///< the parts are those of forces, also where F compares accelerations
};

template <class Scalar>
using MatrixOf = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <class Scalar>
using VectorOf = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// What has to be factorised.
template <class Scalar>
MatrixOf<Scalar> iteration_matrix(const TangentParts& parts, Scalar c) {
  return c * parts.inertia.template cast<Scalar>() + parts.damping.template cast<Scalar>() +
         parts.stiffness.template cast<Scalar>() / c;
}

/// r [2N] → δ in place. `solve(x)` answers the factorised iteration matrix's solution for x [independent].
template <class Scalar, class Solve>
void solve_newton(const TangentParts& parts, const VelocityTransformation& rz, Scalar c, const Solve& solve,
                  VectorOf<Scalar>& r) {
  using OfScalar = VectorOf<Scalar>;
  const int nf = rz.freedom();
  const Eigen::Index n = r.size() / 2;
  const std::vector<int>& independent = rz.independent();
  OfScalar first(nf), second(nf);
  for (int i = 0; i < nf; ++i) {
    first[i] = r[independent[i]];
    second[i] = r[n + independent[i]];
  }
  const OfScalar acceleration = parts.derivatives ? second : OfScalar(OfScalar::Zero(nf));
  // The analytic tangent is that of the forces: derivatives' residuals become forces by the mass matrix.
  if (parts.derivatives && parts.of_forces) second = (parts.inertia * second).eval();
  if (parts.stiffness_to_all.size() > 0)
    second -= parts.stiffness_to_all * r.head(n) / c;  // dependent positions have residuals of their own
  else
    second -= parts.stiffness * first / c;
  const OfScalar rate = solve(second);
  if (!rz.trivial()) {
    // Dependent rows: q'_d follows Rz q'_i, and the independent residual has already taken its share of
    // q''_d.
    const OfScalar followed = rz.dependent_rates() * rate;
    const OfScalar shared = rz.dependent_rates() * acceleration;
    for (std::size_t d = 0; d < rz.dependent().size(); ++d) {
      const int k = rz.dependent()[d];
      r[k] = (r[k] + followed[d]) / c;
      r[n + k] = (r[n + k] - shared[d]) / c + followed[d];
    }
  }
  for (int i = 0; i < nf; ++i) {
    const int k = independent[i];
    r[k] = (first[i] + rate[i]) / c;
    r[n + k] = rate[i];
  }
}

}  // namespace sinew::multibody
