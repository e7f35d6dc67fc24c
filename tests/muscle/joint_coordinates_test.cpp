// Offsets from a reference: derivative in the chart, inverse, and carrying over to a moved reference.
#include "sinew/muscle/joint_coordinates.h"

#include <gtest/gtest.h>

#include "residual/random_tree.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using fixtures::Random;

class JointCoordinates : public testing::TestWithParam<unsigned> {
 protected:
  Tree<double> tree_{fixtures::random_skeleton(GetParam())};
  Random random_{GetParam() + 40};
};

TEST_P(JointCoordinates, OffsetChangesAsItsJacobianSays) {
  const auto reference = fixtures::random_pose(tree_, random_, 0.5);
  const auto local = fixtures::random_pose(tree_, random_, 0.5);
  constexpr double step = 1e-5;  // central difference: error of order step²
  for (int i = 0; i < tree_.bodies; ++i) {
    const JointOffset<double> at = joint_offset<double>(tree_, i, reference[i], local[i]);
    const int count = tree_.dof_count(i);
    const int rotational = fixtures::rotation_vector_dof(tree_, i) - tree_.first_dof[i];
    for (int k = 0; k < count; ++k) {
      double d[6] = {0, 0, 0, 0, 0, 0};
      d[k] = step;
      const auto ahead =
          joint_offset<double>(tree_, i, reference[i], displaced<double>(tree_, i, local[i], d));
      d[k] = -step;
      const auto behind =
          joint_offset<double>(tree_, i, reference[i], displaced<double>(tree_, i, local[i], d));
      for (int row = 0; row < count; ++row) {
        const bool turns = rotational >= 0 && row >= rotational && k >= rotational;
        const double expected =
            turns ? at.rotational(row - rotational, k - rotational) : (row == k ? 1.0 : 0.0);
        EXPECT_NEAR((ahead.value[row] - behind.value[row]) / (2 * step), expected, 1e-8)
            << "joint type " << int(tree_.type[i]) << " offset " << row << " dof " << k;
      }
    }
  }
}

TEST_P(JointCoordinates, AtOffsetInvertsJointOffset) {
  const auto reference = fixtures::random_pose(tree_, random_, 0.5);
  for (int i = 0; i < tree_.bodies; ++i) {
    std::array<double, 6> offset{};
    for (int k = 0; k < tree_.dof_count(i); ++k) offset[k] = random_.normal(0.4);
    const Transform<double> moved = at_offset<double>(tree_, i, reference[i], offset);
    const JointOffset<double> back = joint_offset<double>(tree_, i, reference[i], moved);
    for (int k = 0; k < tree_.dof_count(i); ++k)
      EXPECT_NEAR(back.value[k], offset[k], 1e-12) << "joint type " << int(tree_.type[i]) << " dof " << k;
  }
}

TEST_P(JointCoordinates, RebasedKeepsTheJointsOwnFreedom) {
  const auto old_reference = fixtures::random_pose(tree_, random_, 0.3);
  const auto local = fixtures::random_pose(tree_, random_, 0.3);
  for (int i = 0; i < tree_.bodies; ++i) {
    // The clip moves the joint across its axes: a small roll and a bone that stretches.
    Transform<double> reference = old_reference[i];
    reference.translation += random_.vector(0.01);
    const Transform<double> carried = rebased<double>(tree_, i, reference, local[i]);
    // A rebased joint differs from the reference by its own degrees of freedom only.
    const auto offset = joint_offset<double>(tree_, i, reference, carried);
    const Transform<double> rebuilt = at_offset<double>(tree_, i, reference, offset.value);
    EXPECT_LT((rebuilt.translation - carried.translation).norm(), 1e-12) << int(tree_.type[i]);
    EXPECT_LT(rebuilt.rotation.angularDistance(carried.rotation), 1e-7) << int(tree_.type[i]);
    if (tree_.type[i] == JointType::kRevolute || tree_.type[i] == JointType::kBall) {
      EXPECT_LT(carried.rotation.angularDistance(local[i].rotation), 1e-7) << int(tree_.type[i]);
    }
  }
}

TEST_P(JointCoordinates, HingeIgnoresWhatTheReferenceDoesAcrossItsAxis) {
  for (int i = 0; i < tree_.bodies; ++i) {
    if (tree_.type[i] != JointType::kRevolute) continue;
    const V axis = tree_.axis[i];
    Transform<double> reference = tree_.rest[i], local = tree_.rest[i];
    const Quat<double> roll = rotation_exp<double>(axis.unitOrthogonal() * 0.2);
    reference.rotation = tree_.rest[i].rotation * roll * rotation_exp<double>(axis * 0.5);
    local.rotation = tree_.rest[i].rotation * rotation_exp<double>(axis * 0.9);
    EXPECT_NEAR(joint_offset<double>(tree_, i, reference, local).value[0], 0.4, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, JointCoordinates, testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace sinew
