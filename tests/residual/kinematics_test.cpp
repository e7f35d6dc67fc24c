// Forward kinematics: motion axes against differences, and the role of the common origin.
#include <gtest/gtest.h>

#include "residual/random_tree.h"
#include "sinew/residual/tree.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using fixtures::Random;

bool moves(const Tree<double>& tree, int joint, int body) {
  while (body > joint) body = tree.parent[body];
  return body == joint;
}

class Kinematic : public testing::TestWithParam<unsigned> {};

TEST_P(Kinematic, MotionAxesAreTheDerivativeOfEveryBody) {
  const Tree<double> tree(fixtures::random_skeleton(GetParam()));
  Random random(GetParam() + 100);
  const auto pose = fixtures::random_pose(tree, random, 0.7);
  const V origin(3, -2, 1);
  Kinematics<double> at(tree), ahead(tree), behind(tree);
  forward_kinematics<double>(tree, pose, origin, at);
  constexpr double step = 1e-5;  // central difference: error of order step² = 1e-10, times curvature
  std::vector<double> d(tree.dofs, 0.0);
  for (int k = 0; k < tree.dofs; ++k) {
    d[k] = step;
    forward_kinematics<double>(tree, fixtures::displaced_pose(tree, pose, d.data()), origin, ahead);
    d[k] = -step;
    forward_kinematics<double>(tree, fixtures::displaced_pose(tree, pose, d.data()), origin, behind);
    d[k] = 0;
    for (int i = 0; i < tree.bodies; ++i) {
      const bool moved = moves(tree, tree.dof_body[k], i);
      const V w = moved ? at.w[k] : V(V::Zero()), v = moved ? at.v[k] : V(V::Zero());
      const V center = (ahead.center[i] - behind.center[i]) / (2 * step);
      EXPECT_LT((center - (v + w.cross(at.center[i]))).norm(), 1e-8) << "dof " << k << " body " << i;
      const Mat3<double> turn = (ahead.rotation[i] - behind.rotation[i]) / (2 * step);
      EXPECT_LT((turn - skew(w) * at.rotation[i]).norm(), 1e-8) << "dof " << k << " body " << i;
    }
  }
}

TEST_P(Kinematic, CommonOriginOnlyShiftsPositions) {
  const Tree<double> tree(fixtures::random_skeleton(GetParam()));
  Random random(GetParam() + 200);
  const auto pose = fixtures::random_pose(tree, random, 0.7);
  const V origin(30, -20, 10);
  Kinematics<double> here(tree), there(tree);
  forward_kinematics<double>(tree, pose, V::Zero(), here);
  forward_kinematics<double>(tree, pose, origin, there);
  for (int i = 0; i < tree.bodies; ++i) EXPECT_LT((here.center[i] - origin - there.center[i]).norm(), 1e-12);
  for (int k = 0; k < tree.dofs; ++k) {
    EXPECT_LT((here.w[k] - there.w[k]).norm(), 1e-12);
    // Velocity of the material point at the origin in use.
    EXPECT_LT((here.v[k] + here.w[k].cross(origin) - there.v[k]).norm(), 1e-12);
  }
}

TEST_P(Kinematic, ProjectedWrenchesAreVirtualWork) {
  const Tree<double> tree(fixtures::random_skeleton(GetParam()));
  Random random(GetParam() + 300);
  const auto pose = fixtures::random_pose(tree, random, 0.7);
  Kinematics<double> k(tree);
  forward_kinematics<double>(tree, pose, V::Zero(), k);
  std::vector<V> force, moment;
  for (int i = 0; i < tree.bodies; ++i) {
    force.push_back(random.vector());
    moment.push_back(random.vector());
  }
  std::vector<double> expected(tree.dofs, 0.0), projection(tree.dofs);
  for (int d = 0; d < tree.dofs; ++d)
    for (int i = 0; i < tree.bodies; ++i)
      if (moves(tree, tree.dof_body[d], i)) expected[d] += k.w[d].dot(moment[i]) + k.v[d].dot(force[i]);
  project_wrenches<double>(tree, k, force, moment, projection);
  for (int d = 0; d < tree.dofs; ++d) EXPECT_NEAR(projection[d], expected[d], 1e-11) << d;
}

INSTANTIATE_TEST_SUITE_P(Seeds, Kinematic, testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace sinew
