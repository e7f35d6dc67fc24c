// The matrix that is kept joint by joint against the one that is kept path by path, on random trees.
#include "sinew/residual/articulated_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "residual/random_tree.h"

namespace sinew {
namespace {

using fixtures::Random;

class Articulated : public testing::TestWithParam<unsigned> {
 protected:
  Random random_{GetParam()};
  Skeleton skeleton_ = fixtures::random_skeleton(GetParam());
  Tree<double> tree_{skeleton_};
  Kinematics<double> kinematics_{tree_};
  std::vector<Composite<double>> bodies_{std::size_t(tree_.bodies)};
  Unknowns unknowns_;
  TreeMatrix<double> paths_{unknowns_.pattern};
  ArticulatedMatrix<double> joints_;

  /// At a random pose, with forces and couples of `load` of what inertia is like; all but every
  /// `left_out`th joint's degrees of freedom are unknowns.
  void assemble(bool geometric, int left_out, double load) {
    forward_kinematics<double>(tree_, fixtures::random_pose(tree_, random_, 0.5), Vec3<double>::Zero(),
                               kinematics_);
    for (int i = 0; i < tree_.bodies; ++i) {
      const Mat3<double>& r = kinematics_.rotation[i];
      bodies_[i] = {};
      bodies_[i].add_body(tree_.mass[i], kinematics_.center[i], r * tree_.inertia[i] * r.transpose());
      bodies_[i].add_force(kinematics_.center[i], random_.vector(load * tree_.mass[i]));
      bodies_[i].couple = random_.vector(load * tree_.mass[i]);
    }
    std::vector<std::uint8_t> free(tree_.dofs);
    for (int dof = 0; dof < tree_.dofs; ++dof) free[dof] = tree_.dof_body[dof] % left_out != 1;
    const int first = append_unknowns<double>(tree_, free, unknowns_);
    PathAxes<double> axes;
    axes.append(tree_, kinematics_, unknowns_, first);
    std::vector<Composite<double>> bodies = bodies_;
    paths_.set_zero();
    assemble_tree_matrix<double>(tree_, kinematics_, axes, bodies, unknowns_, first, geometric, paths_);
    add_floor<double>(tree_, kinematics_, bodies, unknowns_, first, paths_);
    joints_.reserve(tree_.bodies, tree_.dofs);
    joints_.assemble(tree_, kinematics_, bodies_, unknowns_, geometric);
  }
  std::vector<double> random_vector() {
    std::vector<double> x(unknowns_.pattern.size);
    std::generate(x.begin(), x.end(), [&] { return random_.normal(); });
    return x;
  }
  /// Entry by entry, to rounding of the sums that it is made of.
  static void expect_same(const std::vector<double>& a, const std::vector<double>& b, double rounding) {
    double largest = 0;
    for (const double x : b) largest = std::max(largest, std::abs(x));
    for (std::size_t k = 0; k < b.size(); ++k) EXPECT_NEAR(a[k], b[k], rounding * largest) << k;
  }
};

TEST_P(Articulated, MultipliesAsTheMatrixOfPaths) {
  for (const int left_out : {1000, 3}) {
    unknowns_.clear();
    assemble(true, left_out, 30);
    const std::vector<double> x = random_vector();
    std::vector<double> by_joints(x.size()), by_paths(x.size());
    joints_.multiply(x, by_joints);
    paths_.multiply(x, by_paths);
    expect_same(by_joints, by_paths, 1e-13);
  }
}

TEST_P(Articulated, SolvesAsTheMatrixOfPathsAlsoWithWhatJointsAdd) {
  for (const bool geometric : {false, true}) {
    unknowns_.clear();
    assemble(geometric, 1000, geometric ? 1e-3 : 30);
    joints_.begin_factor();
    for (int k = 0; k < unknowns_.pattern.size; ++k) {
      const double stiffness = 0.1 + random_.below(3);
      joints_.add_to_factor(k, k, stiffness);
      paths_.row(k)[unknowns_.pattern.depth[k]] += stiffness;
    }
    std::vector<double> by_joints = random_vector(), by_paths = by_joints;
    ASSERT_TRUE(paths_.factorise());
    ASSERT_TRUE(joints_.factorise());
    paths_.solve(by_paths);
    joints_.solve(by_joints);
    expect_same(by_joints, by_paths, 1e-10);  // two solves, of a condition below 1e5
  }
}

TEST_P(Articulated, IsIndefiniteWhereTheMatrixOfPathsIs) {
  assemble(true, 1000, 1e4);
  joints_.begin_factor();
  EXPECT_FALSE(paths_.factorise());
  EXPECT_FALSE(joints_.factorise());
}

INSTANTIATE_TEST_SUITE_P(Seeds, Articulated, testing::Values(1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u));

}  // namespace
}  // namespace sinew
