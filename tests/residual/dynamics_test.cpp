// The recursive residual against energies: power balance is not enough, so the Euler–Lagrange equations are
// differenced coordinate by coordinate.
#include "sinew/residual/dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "residual/random_tree.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Eigen::VectorXd;
using fixtures::Random;

const V kGravity(0.3, -0.2, -9.81);

V three(const double* x) {
  return {x[0], x[1], x[2]};
}

/// The state at displacement d and rate `rate` in the charts centred at `base`.
std::vector<JointState> in_chart(const Tree<double>& tree, const std::vector<JointState>& base,
                                 const VectorXd& d, const VectorXd& rate) {
  std::vector<JointState> states = base;
  for (int i = 0; i < tree.bodies; ++i) {
    JointState& s = states[i];
    const int first = tree.first_dof[i], count = tree.dof_count(i);
    for (int k = 0; k < count; ++k) s.v[k] = rate[first + k];
    if (const int r = fixtures::rotation_vector_dof(tree, i); r >= 0) {
      const V turn = three(&d[r]);
      const V omega = fixtures::chart_jacobian(tree, i, turn) * three(&rate[r]);
      for (int a = 0; a < 3; ++a) s.v[r - first + a] = omega[a];
      const bool ball = tree.type[i] == JointType::kBall;
      s.rotation = ball ? s.rotation * rotation_exp(turn) : rotation_exp(turn) * s.rotation;
      if (!ball) s.position += three(&d[first]);
    } else {
      for (int k = 0; k < count; ++k) s.q[k] += d[first + k];
    }
  }
  return states;
}

struct Model {
  Skeleton skeleton;
  Tree<double> tree;
  std::vector<JointState> states;
  VectorXd v, a;

  explicit Model(unsigned seed)
      : skeleton(fixtures::random_skeleton(seed)), tree(skeleton), states(tree.bodies) {
    Random random(seed + 1000);
    v = VectorXd::NullaryExpr(tree.dofs, [&] { return random.normal(); });
    a = VectorXd::NullaryExpr(tree.dofs, [&] { return random.normal(3); });
    for (int i = 0; i < tree.bodies; ++i) {
      for (double& q : states[i].q) q = random.normal(0.6);
      states[i].rotation = random.rotation();
      states[i].position = random.vector();
      for (int k = 0; k < tree.dof_count(i); ++k) {
        states[i].v[k] = v[tree.first_dof[i] + k];
        states[i].a[k] = a[tree.first_dof[i] + k];
      }
    }
  }
  DynamicsResult evaluate(const V& gravity = kGravity) const {
    return evaluate_dynamics(skeleton, states, gravity);
  }
};

class Dynamics : public testing::TestWithParam<unsigned> {};

TEST_P(Dynamics, ResidualSatisfiesTheEulerLagrangeEquations) {
  const Model m(GetParam());
  const int n = m.tree.dofs;
  const auto kinetic = [&](const VectorXd& d, const VectorXd& rate) {
    return evaluate_dynamics(m.skeleton, in_chart(m.tree, m.states, d, rate), kGravity).kinetic_energy;
  };
  const auto lagrangian = [&](const VectorXd& d) {
    const DynamicsResult r = evaluate_dynamics(m.skeleton, in_chart(m.tree, m.states, d, m.v), kGravity);
    return r.kinetic_energy - r.potential_energy;
  };
  constexpr double step = 1e-4;  // truncation step² = 1e-8, rounding 1e-16·energy/step
  const VectorXd residual = m.evaluate().inverse_dynamics;
  for (int k = 0; k < n; ++k) {
    const VectorXd e = VectorXd::Unit(n, k);
    // Kinetic energy is quadratic in the rates: this difference is exact.
    const auto momentum = [&](double t) {
      const VectorXd d = m.v * t + 0.5 * m.a * t * t, rate = m.v + m.a * t;
      return 0.5 * (kinetic(d, rate + e) - kinetic(d, rate - e));
    };
    const double inertial = (momentum(step) - momentum(-step)) / (2 * step);
    const double gradient = (lagrangian(step * e) - lagrangian(-step * e)) / (2 * step);
    EXPECT_NEAR(residual[k], inertial - gradient, 1e-6 * residual.norm()) << "dof " << k;
  }
}

TEST_P(Dynamics, ResidualIsMassMatrixTimesAccelerationPlusBias) {
  Model m(GetParam());
  const DynamicsResult full = m.evaluate();
  for (JointState& s : m.states) std::fill(std::begin(s.a), std::end(s.a), 0.0);
  const VectorXd bias = m.evaluate().inverse_dynamics;
  const VectorXd expected = full.mass_matrix * m.a + bias;
  EXPECT_LT((full.inverse_dynamics - expected).norm(), 1e-11 * expected.norm());
}

TEST_P(Dynamics, MassMatrixGivesTheKineticEnergy) {
  const Model m(GetParam());
  const DynamicsResult r = m.evaluate();
  EXPECT_NEAR(0.5 * m.v.dot(r.mass_matrix * m.v), r.kinetic_energy, 1e-11 * r.kinetic_energy);
  EXPECT_EQ(r.mass_matrix.llt().info(), Eigen::Success);
}

TEST_P(Dynamics, ForwardDynamicsLeaveNoTorque) {
  Model m(GetParam());
  const VectorXd acceleration = m.evaluate().forward_dynamics;
  for (int i = 0; i < m.tree.bodies; ++i)
    for (int k = 0; k < m.tree.dof_count(i); ++k) m.states[i].a[k] = acceleration[m.tree.first_dof[i] + k];
  const DynamicsResult r = m.evaluate();
  const double scale = (r.mass_matrix * acceleration).norm();
  EXPECT_LT(r.inverse_dynamics.norm(), 1e-10 * scale);
}

TEST_P(Dynamics, FreeFallAtRestNeedsNoTorque) {
  Model m(GetParam());
  for (JointState& s : m.states) {
    std::fill(std::begin(s.v), std::end(s.v), 0.0);
    std::fill(std::begin(s.a), std::end(s.a), 0.0);
  }
  for (int a = 0; a < 3; ++a) m.states[0].a[a] = kGravity[a];
  EXPECT_LT(m.evaluate().inverse_dynamics.norm(), 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Dynamics, testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace sinew
