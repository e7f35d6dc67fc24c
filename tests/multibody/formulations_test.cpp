// Every formulation is the same mechanics: they agree on random states, and with equations written down
// directly.
#include <Eigen/Dense>

#include "mechanisms.h"

namespace sinew::multibody {
namespace {

/// The promise: relative agreement on random states. Rounding alone gives 1e-15 (five bodies) to 1e-12 (the
/// driver, whose joint stiffnesses span six decades).
constexpr double kAgreement = 1e-10;

/// Relative size of the residual that remains at accelerations `yp`, against the inertia forces that they
/// call up.
double relative_residual(Equations& equations, double t, const Vector& y, const Vector& yp) {
  const Eigen::Index n = y.size() / 2;
  Vector left(2 * n), without(2 * n), resting = yp;
  resting.tail(n).setZero();
  EXPECT_TRUE(equations.residual(t, y, yp, left));
  EXPECT_TRUE(equations.residual(t, y, resting, without));
  return left.norm() / without.norm();
}

TEST(Formulations, ArticulatedSemiRecursiveAndResidualAgreeOnOpenChains) {
  std::mt19937 random(20260701);
  for (const std::string& path : open_mechanisms()) {
    const Model model(loaded(path));
    Equations dtr(model, Formulation::kDtr, Tangent::kNumeric),
        dsr(model, Formulation::kDsr, Tangent::kNumeric), rr(model, Formulation::kRr, Tangent::kNumeric);
    for (int trial = 0; trial < 20; ++trial) {
      const Vector y = disturbed_start(dtr, 0.5, random);
      Vector by_dtr(y.size()), by_dsr(y.size());
      ASSERT_TRUE(dtr.derivative(0.1, y, by_dtr));
      ASSERT_TRUE(dsr.derivative(0.1, y, by_dsr));
      EXPECT_LT((by_dtr - by_dsr).norm(), kAgreement * by_dtr.norm()) << path << " trial " << trial;
      EXPECT_LT(relative_residual(rr, 0.1, y, by_dtr), kAgreement) << path << " trial " << trial;
    }
  }
}

TEST(Formulations, SemiRecursiveAndResidualAgreeOnClosedChains) {
  std::mt19937 random(20260702);
  for (const std::string& path : closed_mechanisms()) {
    const Model model(loaded(path));
    Equations dsr(model, Formulation::kDsr, Tangent::kNumeric),
        rr(model, Formulation::kRr, Tangent::kNumeric);
    for (int trial = 0; trial < 20; ++trial) {
      Vector unused, y = disturbed_start(dsr, 0.02, random), yp(y.size());
      ASSERT_EQ(rr.start(unused), "");
      ASSERT_TRUE(dsr.derivative(0.1, y, yp)) << path;
      EXPECT_LT(relative_residual(rr, 0.1, y, yp), kAgreement) << path << " trial " << trial;
    }
  }
}

TEST(Formulations, OnClosedPositionsIndexTwoIsTheSameMechanics) {
  // Cholesky against orthogonal factors: squaring costs digits, 1e-10 at the conditioning where it is given
  // up.
  std::mt19937 random(20260714);
  for (const std::string& path : closed_mechanisms()) {
    const Model model(loaded(path));
    Equations in_evaluations(model, Formulation::kDsr, Tangent::kNumeric),
        in_steps(model, Formulation::kDsr, Tangent::kNumeric, Closure::kInSteps);
    for (int trial = 0; trial < 5; ++trial) {
      Vector unused, y = disturbed_start(in_evaluations, 0.02, random), a(y.size()), b(y.size());
      ASSERT_EQ(in_steps.start(unused), "");
      ASSERT_TRUE(in_evaluations.close(y));
      ASSERT_TRUE(in_evaluations.derivative(0.1, y, a));
      ASSERT_TRUE(in_steps.derivative(0.1, y, b));
      EXPECT_LT((a - b).norm(), 1e-9 * (1 + a.norm())) << path << " trial " << trial;
    }
  }
}

TEST(Formulations, ClosedChainsObeyTheirLoopsAndMultipliersExplainTheRest) {
  // Directly: Φ_q q'' = γ, and what M q'' − Q lacks is in the range of Φ_qᵀ (equation 34), by a projector
  // from a singular value decomposition, in which no choice of independent coordinates occurs.
  std::mt19937 random(20260703);
  for (const std::string& path : closed_mechanisms()) {
    const Model model(loaded(path));
    const int n = model.size();
    Equations equations(model, Formulation::kDsr, Tangent::kNumeric);
    SemiRecursive tree(model);
    AppliedForces applied(model);
    for (int trial = 0; trial < 5; ++trial) {
      Vector y = disturbed_start(equations, 0.02, random), yp(2 * n), gamma(model.loop_rows), q_force(n);
      ASSERT_TRUE(equations.close(y));
      ASSERT_TRUE(equations.derivative(0.1, y, yp));
      BodyMotion motion(model);
      move_to(model, y.head(n), motion);
      set_rates(model, y.tail(n), motion);
      Matrix jacobian(model.loop_rows, n), mass(n, n);
      closure_jacobian(model, motion, jacobian);
      accelerate(model, Vector::Zero(n), motion);
      closure_acceleration(model, motion, gamma);
      apply_forces(model, 0.1, y.head(n), y.tail(n), motion, applied);
      tree.mass_matrix(motion, mass);
      tree.forces(motion, applied, q_force);
      const Vector loops = jacobian * yp.tail(n) + gamma;
      EXPECT_LT(loops.norm(), kAgreement * (1 + gamma.norm() + yp.norm())) << path;
      const Vector constraint_force = mass * yp.tail(n) - q_force;
      Eigen::JacobiSVD<Matrix> svd(jacobian, Eigen::ComputeFullV);
      svd.setThreshold(1e-9);
      const Vector free = svd.matrixV().rightCols(n - svd.rank()).transpose() * constraint_force;
      EXPECT_LT(free.norm(), kAgreement * (q_force.norm() + constraint_force.norm())) << path;
    }
  }
}

TEST(Formulations, LoopRatesAndAccelerationsAreTimeDerivativesOfTheGap) {
  // Central differences over 1e-4 s along q(t) = q + q' t + q'' t²/2: their error is about 1e-8 of Φ''' and
  // 1e-16/h².
  std::mt19937 random(20260704);
  std::normal_distribution<double> normal;
  for (const std::string& path : closed_mechanisms()) {
    const Model model(loaded(path));
    const int n = model.size();
    Equations equations(model, Formulation::kDsr, Tangent::kNumeric);
    Vector y = disturbed_start(equations, 0.1, random), qdd(n);
    // A gap would turn with the bodies that carry both its ends; Φ_q is exact where there is none.
    ASSERT_TRUE(equations.close(y)) << path;
    for (double& x : qdd) x = normal(random);
    BodyMotion motion(model);
    const double h = 1e-4;
    const auto gap_at = [&](double t) {
      Vector phi(model.loop_rows);
      move_to(model, Vector(y.head(n) + t * y.tail(n) + 0.5 * t * t * qdd), motion);
      closure(model, motion, phi);
      return phi;
    };
    const Vector before = gap_at(-h), after = gap_at(h), now = gap_at(0);
    Matrix jacobian(model.loop_rows, n);
    Vector acceleration(model.loop_rows);
    closure_jacobian(model, motion, jacobian);
    set_rates(model, y.tail(n), motion);
    accelerate(model, qdd, motion);
    closure_acceleration(model, motion, acceleration);
    EXPECT_LT((jacobian * y.tail(n) - (after - before) / (2 * h)).norm(), 1e-6) << path;
    EXPECT_LT((acceleration - (after - 2 * now + before) / (h * h)).norm(), 1e-5 * (1 + acceleration.norm()))
        << path;
  }
}

TEST(Formulations, LongChainsKeepTheirAgreement) {
  // A thousand links: articulated inertias and residuals, both O(N), still agree.
  const Model model(serial_chain(1000));
  Equations dtr(model, Formulation::kDtr, Tangent::kNumeric), rr(model, Formulation::kRr, Tangent::kNumeric);
  std::mt19937 random(20260705);
  const Vector y = disturbed_start(dtr, 0.05, random);
  Vector yp(y.size());
  ASSERT_TRUE(dtr.derivative(0, y, yp));
  EXPECT_LT(relative_residual(rr, 0, y, yp), kAgreement);
}

TEST(Formulations, FigureOneHasTheResidualsAndAccelerationsOfTheDocumentation) {
  // Numbers printed in runtime/sinew/multibody/README.md, to the digits printed there.
  const Model model(loaded(kOwn + "figure1.json"));
  Equations rr(model, Formulation::kRr, Tangent::kNumeric), dtr(model, Formulation::kDtr, Tangent::kNumeric);
  Vector y, yp = Vector::Zero(12), r(12);
  ASSERT_EQ(rr.start(y), "");
  ASSERT_TRUE(rr.residual(0, y, yp, r));
  EXPECT_LT((r.tail(6) - Vector{{-3.116, 0.067, 1.904, -10.45, 0.829, 0}}).cwiseAbs().maxCoeff(), 5e-3);
  ASSERT_TRUE(dtr.derivative(0, y, yp));
  EXPECT_LT((yp.tail(6) - Vector{{-3.878, -0.156, -4.510, 16.03, -23.25, 0}}).cwiseAbs().maxCoeff(), 5e-3);
}

TEST(Formulations, AccumulatedInertiasOfFigureOneAreSumsOverWhatEachJointCarries) {
  // Equation 31 on the tree of the paper's Figure 1: at a hinge of unit rate the kinetic energy is ½·M_ii,
  // and joints on different branches (2 and 5) are not coupled: the zeros of equation 30.
  const Model model(loaded(kOwn + "figure1.json"));
  BodyMotion motion(model);
  move_to(model, Vector::Constant(6, 0.3), motion);
  SemiRecursive semi(model);
  Matrix mass(6, 6);
  semi.mass_matrix(motion, mass);
  for (int i = 0; i < 6; ++i) {
    set_rates(model, Vector::Unit(6, i), motion);
    EXPECT_NEAR(kinetic_energy(model, motion), 0.5 * mass(i, i), 1e-14);
  }
  for (const auto& [i, k] : {std::pair{1, 3}, {1, 4}, {1, 5}, {2, 3}, {2, 4}, {2, 5}, {4, 5}})
    EXPECT_EQ(mass(i, k), 0) << i << " " << k;
  EXPECT_NE(mass(0, 4), 0);
}

}  // namespace
}  // namespace sinew::multibody
