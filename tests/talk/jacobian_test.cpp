// The talk's Jacobians, written out from its slides, against the motion axes of the kernel.
#include <gtest/gtest.h>

#include "fixtures/paths.h"
#include "scene/scene.h"
#include "sinew/residual/tree.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Matrix = Eigen::MatrixXd;

constexpr double kRounding = 1e-14;  ///< of entries of order 1 m in double precision

Skeleton skeleton_of(const char* name) {
  scene::Scene scene;
  const convert::Error error =
      scene::load_scene(source_dir() + "/assets/scenes/talk/" + name + ".json", scene);
  EXPECT_FALSE(error) << error.message;
  return scene.characters[0].asset->skeleton;
}

Mat3<double> skew_of(const V& a) {
  Mat3<double> m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

struct Posed {
  Tree<double> tree;
  std::vector<Transform<double>> local;
  Kinematics<double> kinematics{tree};

  explicit Posed(const Skeleton& skeleton) : tree(skeleton), local(tree.rest) {}
  void move(int body, const double* d) { local[body] = displaced<double>(tree, body, local[body], d); }
  void place() { forward_kinematics<double>(tree, local, V::Zero(), kinematics); }

  /// [6 body, dof] linear velocity of the centre of mass, then angular: what the motion axes say.
  Matrix jacobian() const {
    Matrix j = Matrix::Zero(6 * tree.bodies, tree.dofs);
    for (int i = 0; i < tree.bodies; ++i)
      for (int at = i; at >= 0; at = tree.parent[at])
        for (int dof = tree.first_dof[at]; dof < tree.first_dof[at + 1]; ++dof) {
          j.block<3, 1>(6 * i, dof) = kinematics.v[dof] + kinematics.w[dof].cross(kinematics.center[i]);
          j.block<3, 1>(6 * i + 3, dof) = kinematics.w[dof];
        }
    return j;
  }
};

/// L0 somewhere, L1 bent against it.
Posed linked_bodies() {
  Posed p(skeleton_of("linked_bodies"));
  const double root[] = {0.3, -0.2, 0.4, 0.5, -0.7, 0.9}, relative[] = {-0.4, 0.8, 0.3};
  p.move(0, root);
  p.move(1, relative);
  p.place();
  return p;
}

TEST(TalkJacobian, HingeIsCrossOfAxisAndArmThenAxis) {
  // "Constrained Rigid Body": J = { Cross(a,r), a }.
  Posed p(skeleton_of("hinge"));
  ASSERT_EQ(p.tree.dofs, 1);
  for (const double turn : {0.3, 0.7, -2.5}) {
    p.move(0, &turn);
    p.place();
    const V a = V::UnitY(), r = p.kinematics.center[0] - p.kinematics.origin[0];
    const Matrix j = p.jacobian();
    EXPECT_LT((j.block<3, 1>(0, 0) - a.cross(r)).norm(), kRounding);
    EXPECT_LT((j.block<3, 1>(3, 0) - a).norm(), kRounding);
  }
}

TEST(TalkJacobian, NineByTwelveOfLinkedBodies) {
  // "Linked Bodies Kinematics": angular  Vl0.angular + A0*q1,
  //                             linear   Vl0.linear + cross(Vl0.angular, r0+r1) + cross(A0*q1, r1).
  const Posed p = linked_bodies();
  ASSERT_EQ(p.tree.dofs, 9);
  ASSERT_EQ(p.tree.bodies, 2);
  const Kinematics<double>& k = p.kinematics;
  const Mat3<double> one = Mat3<double>::Identity(), a0 = k.rotation[0], a1 = k.rotation[1];
  const V pivot = k.origin[1], r0 = pivot - k.center[0], r1 = k.center[1] - pivot;
  Matrix talk = Matrix::Zero(12, 9);
  talk.block<6, 6>(0, 0).setIdentity();  // "The Jacobian for L0 is just I for its own DOF and 0 for L1's"
  talk.block<3, 3>(6, 0) = one;
  talk.block<3, 3>(6, 3) = -skew_of(r0 + r1);
  talk.block<3, 3>(6, 6) = -skew_of(r1) * a0;
  talk.block<3, 3>(9, 3) = one;
  talk.block<3, 3>(9, 6) = a0;
  // The talk's q1 is "in the local space of L0", the kernel's rates of a ball joint in that of L1.
  talk.rightCols<3>() = (talk.rightCols<3>() * (a0.transpose() * a1)).eval();
  const Matrix kernel = p.jacobian();
  ASSERT_EQ(kernel.rows() * kernel.cols(), 12 * 9);
  for (int row = 0; row < 12; ++row)
    for (int dof = 0; dof < 9; ++dof)
      EXPECT_NEAR(kernel(row, dof), talk(row, dof), kRounding) << "row " << row << ", dof " << dof;
}

TEST(TalkJacobian, IsTheDerivativeOfThePoses) {
  const Posed p = linked_bodies();
  const Matrix kernel = p.jacobian();
  constexpr double step = 1e-6;  // central differences: an error of order step², rounding of 1e-16 / step
  for (int dof = 0; dof < 9; ++dof) {
    Posed both[] = {p, p};
    for (int side = 0; side < 2; ++side) {
      double d[6] = {};
      d[dof < 6 ? dof : dof - 6] = side == 0 ? -step : step;
      both[side].move(dof < 6 ? 0 : 1, d);
      both[side].place();
    }
    for (int i = 0; i < 2; ++i) {
      const auto &before = both[0].kinematics, &after = both[1].kinematics;
      const V linear = (after.center[i] - before.center[i]) / (2 * step);
      const V angular = rotation_log<double>(
                            Quat<double>(Mat3<double>(after.rotation[i] * before.rotation[i].transpose()))) /
                        (2 * step);
      EXPECT_LT((linear - kernel.block<3, 1>(6 * i, dof)).norm(), 1e-8) << "body " << i << ", dof " << dof;
      EXPECT_LT((angular - kernel.block<3, 1>(6 * i + 3, dof)).norm(), 1e-8)
          << "body " << i << ", dof " << dof;
    }
  }
}

TEST(TalkJacobian, ForcesGoBackByItsTranspose) {
  // "This is the Transpose of what we saw on the last slide", by one sweep from the leaves to the root.
  const Posed p = linked_bodies();
  const V force[] = {V(1, -2, 0.5), V(-0.3, 4, 2)}, couple[] = {V(0.2, 0.1, -0.7), V(-1, 0.4, 0.6)};
  Eigen::VectorXd spatial(12);
  std::vector<V> forces, moments;
  for (int i = 0; i < 2; ++i) {
    spatial.segment<3>(6 * i) = force[i];
    spatial.segment<3>(6 * i + 3) = couple[i];
    forces.push_back(force[i]);
    moments.push_back(p.kinematics.center[i].cross(force[i]) + couple[i]);
  }
  std::vector<double> projected(9);
  project_wrenches<double>(p.tree, p.kinematics, forces, moments, projected);
  const Eigen::VectorXd wanted = p.jacobian().transpose() * spatial;
  for (int dof = 0; dof < 9; ++dof) EXPECT_NEAR(projected[dof], wanted[dof], 10 * kRounding) << "dof " << dof;
}

TEST(TalkJacobian, FigureIsTheTalks) {
  // "DOF Breakdown": root (chest) 6, pelvis 3, thighs 3 (*2), knees 1, feet 3, shoulders 3, elbows 1, wrists
  // 3; "a typical character the complete Jacobian might be a 37x84 matrix".
  Posed p(skeleton_of("figure"));
  EXPECT_EQ(p.tree.bodies, 14);
  EXPECT_EQ(p.tree.dofs, 37);
  p.place();
  EXPECT_EQ(p.jacobian().rows(), 84);
  EXPECT_EQ(p.jacobian().cols(), 37);
}

}  // namespace
}  // namespace sinew
