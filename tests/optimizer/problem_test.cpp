// The step's energy: its gradient and its second derivative against differences, for every joint and every
// row.
#include "sinew/optimizer/problem.h"

#include <gtest/gtest.h>

#include "fixtures/standard_plan.h"
#include "residual/random_tree.h"
#include "sinew/optimizer/joint_terms.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Eigen::VectorXd;
using fixtures::Random;

struct Scene {
  Skeleton skeleton;
  Tree<double> tree;
  TreeProblem<double> problem;
  StepSettings<double> settings;
  Random random;

  /// Poses around `spread` rad from each other; `with_rows`: muscles, friction, damping, limits and cones.
  Scene(unsigned seed, double spread, bool with_rows)
      : skeleton(dressed(seed, with_rows)), tree(skeleton), problem(tree, skeleton), random(seed + 500) {
    settings.plan = &standard_plan<double>();
    settings.gravity = {0.3, -0.2, -9.81};
    problem.common_origin = {2, -1, 0.5};
    problem.kink_width = 0.2;  // wide, so that poses fall on both sides of the rounding
    problem.start = fixtures::random_pose(tree, random, 0.5);
    problem.target = near_start(spread);
    problem.local = near_start(spread);
    std::fill(problem.free.begin(), problem.free.end(), std::uint8_t{1});
    problem.pushes.push_back({9, random.vector(0.2), random.vector(50)});
    // Inertia wants to be somewhere near, at an affine prediction that is no rotation.
    Kinematics<double> k(tree);
    forward_kinematics<double>(tree, near_start(spread), problem.common_origin, k);
    problem.prediction.weight = 1 / (settings.h * settings.h);
    for (int i = 0; i < tree.bodies; ++i) {
      problem.prediction.center[i] = k.center[i];
      Mat3<double> bent;
      bent << random.vector(0.02), random.vector(0.02), random.vector(0.02);
      problem.prediction.rotation[i] = k.rotation[i] + bent;
    }
  }
  std::vector<Transform<double>> near_start(double spread) {
    VectorXd d(tree.dofs);
    for (double& x : d) x = random.normal(spread);
    return fixtures::displaced_pose(tree, problem.start, d.data());
  }
  static Skeleton dressed(unsigned seed, bool with_rows) {
    Skeleton s = fixtures::random_skeleton(seed);
    Random random(seed + 900);
    bool every_other = true;
    for (Joint& joint : s.joints) {
      for (DofLimits& dof : joint.dofs) {
        dof.dry_friction = with_rows ? 5 : 0;
        if (!with_rows) continue;
        dof.torque_minus = 40;
        dof.torque_plus = 90;
        dof.damping = 3;
        dof.lower = -0.1;
        dof.upper = 0.3;
      }
      if (with_rows && joint.type == JointType::kBall && random.below(2) == 0) {
        joint.swing_limit = 0.3;
        joint.swing_axis = random.unit();
        joint.twist_lower = -0.2;
        joint.twist_upper = 0.1;
      }
      if (!with_rows || joint.type != JointType::kBall) continue;
      joint.ellipsoidal_limit = every_other;
      every_other = !every_other;
    }
    return s;
  }
  VectorXd gradient() {
    begin_evaluation(settings, problem);
    finish_gradient(problem);
    return VectorXd::Map(problem.gradient.data(), tree.dofs);
  }
};

class Problem : public testing::TestWithParam<unsigned> {};

TEST_P(Problem, GradientIsTheDerivativeOfTheEnergy) {
  Scene s(GetParam(), 0.2, true);
  const VectorXd gradient = s.gradient();
  const auto base = s.problem.local;
  constexpr double step =
      1e-6;  // truncation step² against rounding 1e-16·energy/step: both near 1e-9 relative
  for (int k = 0; k < s.tree.dofs; ++k) {
    VectorXd d = VectorXd::Zero(s.tree.dofs);
    d[k] = step;
    s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
    const double ahead = begin_evaluation(s.settings, s.problem);
    d[k] = -step;
    s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
    const double behind = begin_evaluation(s.settings, s.problem);
    EXPECT_NEAR((ahead - behind) / (2 * step), gradient[k], 1e-6 * gradient.norm()) << "dof " << k;
  }
}

TEST_P(Problem, EveryRowsGradientIsTheDerivativeOfItsScalar) {
  // The whole gradient is dominated by inertia; each row must be right by itself.
  Scene s(GetParam(), 0.2, true);
  s.gradient();
  const auto base = s.problem.local;
  const std::vector<JointRow<double>> rows = s.problem.rows;
  constexpr double step = 1e-5;
  int kinks = 0, springs = 0, limits = 0;
  std::vector<std::vector<JointRow<double>>> ahead(s.tree.dofs), behind(s.tree.dofs);
  for (int k = 0; k < s.tree.dofs; ++k) {
    VectorXd d = VectorXd::Zero(s.tree.dofs);
    for (const double by : {step, -step}) {
      d[k] = by;
      s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
      begin_evaluation(s.settings, s.problem);
      ASSERT_EQ(s.problem.rows.size(), rows.size())
          << "a limit came into range within 1e-5 rad: change the seed";
      (by > 0 ? ahead : behind)[k] = s.problem.rows;
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const JointRow<double>& row = rows[r];
    kinks += row.kind == RowKind::kKink;
    springs += row.kind == RowKind::kSpring;
    limits += row.kind == RowKind::kOneSided && row.value > 0;
    for (int k = 0; k < s.tree.dofs; ++k) {
      const bool own = k >= row.dof && k < row.dof + row.count;
      EXPECT_NEAR((ahead[k][r].value - behind[k][r].value) / (2 * step),
                  own ? row.gradient[k - row.dof] : 0.0, 1e-7)
          << "row " << r << " dof " << k;
    }
  }
  EXPECT_GT(kinks, 40);
  EXPECT_GT(springs, 20);
  EXPECT_GT(limits, 3) << "limits that are violated";
}

TEST_P(Problem, JointCurvatureIsTheSecondDerivativeOfTheRowsScalars) {
  // Σ slope·∂²s/∂d² per ball and free joint, from differences of the rows' own gradients; the chart's second
  // order is the rotation vector's, so mixed differences are symmetrised.
  Scene s(GetParam(), 0.4, true);
  s.gradient();
  const auto base = s.problem.local;
  const std::vector<JointRow<double>> rows = s.problem.rows;
  const std::vector<EllipsoidRow<double>> ellipsoids = s.problem.ellipsoids;
  measure_joint_curvature(s.settings, s.problem);
  const std::vector<Mat3<double>> curvature = s.problem.joint_curvature;
  constexpr double step = 1e-5;
  double largest = 0;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = fixtures::rotation_vector_dof(s.tree, i);
    if (first < 0) continue;
    Mat3<double> difference = Mat3<double>::Zero();
    for (int k = 0; k < 3; ++k) {
      std::vector<JointRow<double>> side[2];
      std::vector<EllipsoidRow<double>> shared[2];
      for (const int n : {0, 1}) {
        VectorXd d = VectorXd::Zero(s.tree.dofs);
        d[first + k] = n == 0 ? step : -step;
        s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
        begin_evaluation(s.settings, s.problem);
        side[n] = s.problem.rows;
        shared[n] = s.problem.ellipsoids;
        ASSERT_EQ(side[n].size(), rows.size());
      }
      for (std::size_t r = 0; r < rows.size(); ++r) {
        if (rows[r].count != 3 || rows[r].dof != first) continue;
        const double slope = rows[r].slope(rows[r].value);
        for (int a = 0; a < 3; ++a)
          difference(a, k) += slope * (side[0][r].gradient[a] - side[1][r].gradient[a]) / (2 * step);
      }
      for (std::size_t e = 0; e < ellipsoids.size(); ++e)
        if (ellipsoids[e].dof == first)
          difference.col(k) += (shared[0][e].gradient - shared[1][e].gradient).transpose() *
                               ellipsoids[e].slope(ellipsoids[e].value) / (2 * step);
    }
    difference = (0.5 * (difference + difference.transpose())).eval();
    largest = std::max(largest, difference.norm());
    EXPECT_LT((difference - curvature[i]).norm(), 1e-6 * (1 + difference.norm()))
        << "joint " << i << " of type " << int(s.tree.type[i]) << "\n"
        << difference << "\n\n"
        << curvature[i];
  }
  EXPECT_GT(largest, 1);
}

TEST_P(Problem, ConesOfBallJointsAreAmongTheRows) {
  Scene with(GetParam(), 0.2, true);
  int cones = 0;
  for (int i = 0; i < with.tree.bodies; ++i) cones += with.problem.law.swing_limit[i] >= 0;
  with.gradient();
  const std::size_t before = with.problem.rows.size();
  for (double& limit : with.problem.law.swing_limit) limit = limit >= 0 ? 1e3 : limit;  // swing out of reach
  with.gradient();
  EXPECT_EQ(before - with.problem.rows.size(), static_cast<std::size_t>(cones));
}

/// Gradient in the chart that stays centred at `base` while the pose is at displacement d.
VectorXd chart_gradient(Scene& s, const std::vector<Transform<double>>& base, const VectorXd& d) {
  s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
  VectorXd g = s.gradient();
  for (int i = 0; i < s.tree.bodies; ++i)
    if (const int r = fixtures::rotation_vector_dof(s.tree, i); r >= 0)
      g.segment<3>(r) =
          (fixtures::chart_jacobian(s.tree, i, V(d.segment<3>(r))).transpose() * g.segment<3>(r)).eval();
  return g;
}

TEST_P(Problem, CompositeMatrixWithGeometricTermsIsTheSecondDerivative) {
  // Near the prediction, where no body's block is clamped to positive.
  Scene s(GetParam(), 0.03, false);
  const int n = s.tree.dofs;
  const auto base = s.problem.local;
  s.gradient();
  begin_composite(s.settings, s.problem);
  Unknowns all;
  const int first = append_unknowns<double>(s.tree, s.problem.free, all);
  TreeMatrix<double> matrix(all.pattern);
  matrix.set_zero();
  PathAxes<double> axes;
  axes.append(s.tree, s.problem.kinematics, all, first);
  assemble_tree_matrix<double>(s.tree, s.problem.kinematics, axes, s.problem.composite, all, first, true,
                               matrix);

  Eigen::MatrixXd difference(n, n);
  constexpr double step = 1e-5;  // central difference of gradients: 1e-10 relative truncation
  for (int k = 0; k < n; ++k) {
    const VectorXd e = VectorXd::Unit(n, k) * step;
    difference.col(k) = (chart_gradient(s, base, e) - chart_gradient(s, base, -e)) / (2 * step);
  }
  for (int k = 0; k < n; ++k) {
    std::vector<bool> on_path(n, false);
    for (int l = k; l >= 0; l = all.pattern.parent[l]) {
      on_path[l] = true;
      // Relative to the diagonal: what matters to the factor.
      const double scale = std::sqrt(std::abs(difference(k, k) * difference(l, l)));
      EXPECT_NEAR(matrix.row(k)[all.pattern.depth[l]], difference(k, l), 1e-6 * scale)
          << "dofs " << k << " (joint type " << int(s.tree.type[s.tree.dof_body[k]]) << ") and " << l
          << " (joint type " << int(s.tree.type[s.tree.dof_body[l]]) << ")";
    }
    for (int l = 0; l < k; ++l) {
      if (!on_path[l]) {
        EXPECT_NEAR(difference(k, l), 0, 1e-6 * difference.norm()) << k << " " << l;
      }
    }
  }
}

TEST_P(Problem, MatrixOverSomeUnknownsIsTheSubmatrix) {
  Scene s(GetParam(), 0.03, false);
  s.gradient();
  const auto assemble = [&](const Unknowns& unknowns, int first) {
    TreeMatrix<double> matrix(unknowns.pattern);
    matrix.set_zero();
    begin_composite(s.settings, s.problem);
    PathAxes<double> axes;
    axes.append(s.tree, s.problem.kinematics, unknowns, first);
    assemble_tree_matrix<double>(s.tree, s.problem.kinematics, axes, s.problem.composite, unknowns, first,
                                 true, matrix);
    return matrix.values();
  };
  Unknowns all, some;
  const std::vector<double> full = assemble(all, append_unknowns<double>(s.tree, s.problem.free, all));
  for (int d = 0; d < s.tree.dofs; ++d) s.problem.free[d] = s.tree.dof_body[d] % 3 != 1;
  const std::vector<double> part = assemble(some, append_unknowns<double>(s.tree, s.problem.free, some));
  ASSERT_LT(some.pattern.size, all.pattern.size);
  for (int k = 0; k < some.pattern.size; ++k)
    for (int l = k; l >= 0; l = some.pattern.parent[l]) {
      const int fk = all.of_dof[some.dof[k]], fl = all.of_dof[some.dof[l]];
      EXPECT_EQ(part[some.pattern.row[k] + some.pattern.depth[l]],
                full[all.pattern.row[fk] + all.pattern.depth[fl]]);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Problem, testing::Values(1u, 2u, 3u, 4u));

}  // namespace
}  // namespace sinew
