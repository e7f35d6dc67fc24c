// The branch-sparse factor, and what rows across branches add to it, against dense Eigen on random trees.
#include "sinew/residual/tree_factor.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "residual/random_tree.h"
#include "sinew/residual/row_factor.h"

namespace sinew {
namespace {

using fixtures::Random;

/// Positive definite matrix with the pattern of a tree: LᵀL of a random L with that pattern.
Eigen::MatrixXd random_matrix(const TreePattern& pattern, Random& random) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(pattern.size, pattern.size);
  for (int k = 0; k < pattern.size; ++k) {
    for (int l = pattern.parent[k]; l >= 0; l = pattern.parent[l]) factor(k, l) = random.normal();
    factor(k, k) = 1 + std::abs(random.normal());
  }
  return factor.transpose() * factor;
}

TreePattern random_pattern(int size, Random& random) {
  TreePattern pattern;
  for (int k = 0; k < size; ++k) pattern.add(k % 11 == 0 ? -1 : (k % 4 == 0 ? random.below(k) : k - 1));
  return pattern;
}

void fill(const TreePattern& pattern, const Eigen::MatrixXd& dense, TreeMatrix<double>& out) {
  out.set_zero();
  for (int k = 0; k < pattern.size; ++k)
    for (int l = k; l >= 0; l = pattern.parent[l]) out.row(k)[pattern.depth[l]] = dense(k, l);
}

class TreeFactor : public testing::TestWithParam<unsigned> {};

TEST_P(TreeFactor, MultipliesAndSolvesAsDense) {
  Random random(GetParam());
  const TreePattern pattern = random_pattern(37, random);
  const Eigen::MatrixXd dense = random_matrix(pattern, random);
  TreeMatrix<double> matrix(pattern);
  fill(pattern, dense, matrix);
  const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(37, [&] { return random.normal(); });

  std::vector<double> product(37);
  matrix.multiply({x.data(), 37}, product);
  const Eigen::VectorXd expected = dense * x;
  for (int k = 0; k < 37; ++k) EXPECT_NEAR(product[k], expected[k], 1e-12 * expected.norm());

  ASSERT_TRUE(matrix.factorise());
  matrix.solve(product);
  // Rounding of a solve: machine precision times the condition number.
  const double condition = dense.norm() * dense.inverse().norm();
  for (int k = 0; k < 37; ++k) EXPECT_NEAR(product[k], x[k], 1e-15 * condition * x.norm());
}

TEST_P(TreeFactor, FactorHasNoFillInAndReproducesTheMatrix) {
  Random random(GetParam() + 50);
  const TreePattern pattern = random_pattern(24, random);
  const Eigen::MatrixXd dense = random_matrix(pattern, random);
  TreeMatrix<double> matrix(pattern);
  fill(pattern, dense, matrix);
  ASSERT_TRUE(matrix.factorise());
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(24, 24);
  for (int k = 0; k < 24; ++k)
    for (int l = k; l >= 0; l = pattern.parent[l]) factor(k, l) = matrix.row(k)[pattern.depth[l]];
  factor.diagonal() = factor.diagonal().cwiseInverse().eval();  // stored so that solves need no division
  EXPECT_LT((factor.transpose() * factor - dense).norm(), 1e-12 * dense.norm());
}

/// Rows between random unknowns of one tree, or of several, at a stiffness; added to `dense` too.
template <class T>
void add_rows(const TreePattern& pattern, int groups, double stiffness, Random& random,
              Eigen::MatrixXd& dense, RowFactor<T>& out) {
  for (int n = 0; n < groups; ++n) {
    const int count = 1 + n % RowFactor<T>::kRows;
    const int leaf[2] = {random.below(pattern.size), n % 5 == 0 ? -1 : random.below(pattern.size)};
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, pattern.size);
    const auto room = out.add(pattern, count, leaf[0], leaf[1]);
    ASSERT_TRUE(room);
    for (int s = 0; s < 2; ++s)
      for (int k = leaf[s]; k >= 0; k = pattern.parent[k])
        for (int i = 0; i < count; ++i) {
          const T value = static_cast<T>(std::sqrt(stiffness) * random.normal());
          room.side[s][pattern.depth[k]][i] = value;
          rows(i, k) += double(value);
        }
    dense += rows.transpose() * rows;
  }
}

TEST_P(TreeFactor, SolvesWithRowsAcrossPathsAsDense) {
  constexpr int kSize = 37;
  Random random(GetParam() + 100);
  const TreePattern pattern = random_pattern(kSize, random);
  Eigen::MatrixXd dense = random_matrix(pattern, random);
  TreeMatrix<double> matrix(pattern);
  fill(pattern, dense, matrix);
  ASSERT_TRUE(matrix.factorise());
  RowFactor<double> rows;
  rows.reserve(20, 40 * kSize);
  for (const int groups : {0, 1, 7, 20}) {
    rows.clear();
    Eigen::MatrixXd both = dense;
    add_rows(pattern, groups, 100, random, both, rows);
    ASSERT_TRUE(rows.factorise(matrix)) << groups;
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(kSize, [&] { return random.normal(); });
    Eigen::VectorXd b = both * x;
    rows.solve(matrix, {b.data(), kSize});
    const double condition = both.norm() * both.inverse().norm();
    EXPECT_LT((b - x).norm(), 1e-14 * condition * x.norm()) << groups;
  }
}

/// What is left to conjugate gradients: rows so stiff that float would lose them, and one group too many.
TEST_P(TreeFactor, RefusesRowsThatItCannotServe) {
  Random random(GetParam() + 150);
  const TreePattern pattern = random_pattern(24, random);
  TreeMatrix<float> matrix(pattern);
  matrix.set_zero();
  for (int k = 0; k < 24; ++k) matrix.row(k)[pattern.depth[k]] = 1;
  ASSERT_TRUE(matrix.factorise());
  RowFactor<float> rows;
  rows.reserve(4, 8 * 24);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(24, 24);
  rows.clear();
  add_rows(pattern, 2, 1e7, random, dense, rows);
  EXPECT_FALSE(rows.factorise(matrix));
  rows.clear();
  add_rows(pattern, 2, 100, random, dense, rows);
  EXPECT_TRUE(rows.factorise(matrix));
  rows.allow(1, 48);
  EXPECT_TRUE(rows.add(pattern, 3, 5, 11));
  EXPECT_FALSE(rows.add(pattern, 3, 5, 11));
  rows.clear();
  EXPECT_TRUE(rows.add(pattern, 3, 5, 11)) << "cleared";
}

INSTANTIATE_TEST_SUITE_P(Seeds, TreeFactor, testing::Values(1u, 2u, 3u, 4u));

TEST(TreeFactor, RefusesIndefiniteAndNan) {
  TreePattern pattern;
  pattern.add(-1);
  pattern.add(0);
  TreeMatrix<double> matrix(pattern);
  const auto set = [&](double coupling) {
    matrix.set_zero();
    matrix.row(0)[0] = matrix.row(1)[1] = 1;
    matrix.row(1)[0] = coupling;
  };
  set(2);  // eigenvalues 3 and −1
  EXPECT_FALSE(matrix.factorise());
  set(std::nan(""));
  EXPECT_FALSE(matrix.factorise());
  set(0.5);
  EXPECT_TRUE(matrix.factorise());
}

}  // namespace
}  // namespace sinew
