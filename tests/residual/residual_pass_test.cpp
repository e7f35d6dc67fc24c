// The residual pass in body axes: alone, and on packs of characters.
#include "sinew/residual/residual_pass.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "residual/random_tree.h"
#include "sinew/animation/kernels/pack_eigen.h"

namespace sinew {
namespace {

constexpr int kLanes = 4;
using P = Pack<float, kLanes>;

template <class T>
std::vector<JointJet<T>> random_jets(const Tree<double>& tree, fixtures::Random& random) {
  const auto pose = fixtures::random_pose(tree, random, 0.6);
  std::vector<JointJet<T>> jets;
  for (const Transform<double>& local : pose) {
    const auto vector = [&](double scale) -> Vec3<T> { return random.vector(scale).template cast<T>(); };
    jets.push_back(
        {local.rotation.cast<T>(), vector(1), vector(3), local.translation.cast<T>(), vector(1), vector(3)});
  }
  return jets;
}

TEST(ResidualPass, TorquesAreTheBodiesWrenchesOnTheMotionAxes) {
  const Vec3<double> gravity(1, -2, -9), origin(0.3, -0.2, 1);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Tree<double> tree(fixtures::random_skeleton(seed));
    fixtures::Random random(seed + 40);
    const auto jets = random_jets<double>(tree, random);
    Kinematics<double> kinematics(tree);
    Motion<double> motion(tree);
    std::vector<Vec3<double>> force(tree.bodies), moment(tree.bodies);
    std::vector<double> wanted(tree.dofs), torque(tree.dofs);
    inertial_wrenches<double>(tree, jets, gravity, origin, kinematics, motion, force, moment);
    project_wrenches<double>(tree, kinematics, force, moment, wanted);
    std::vector<BodyMotion<double>> room(tree.bodies);
    residual_pass<double>(tree, jets, gravity, room, torque);
    double scale = 1;  // rounding of the largest number that a chain of ten joints adds up
    for (const double t : wanted) scale = std::max(scale, std::abs(t));
    for (int dof = 0; dof < tree.dofs; ++dof) EXPECT_NEAR(torque[dof], wanted[dof], 1e-13 * scale);
  }
}

TEST(ResidualPass, EveryLaneOfAPackHasTheBitsOfItsCharacterAlone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Skeleton skeleton = fixtures::random_skeleton(seed);
    const Tree<double> exact(skeleton);
    const Tree<float> tree(skeleton);
    fixtures::Random random(seed + 80);
    std::vector<std::vector<JointJet<float>>> jets;
    for (int lane = 0; lane < kLanes; ++lane) jets.push_back(random_jets<float>(exact, random));
    std::vector<JointJet<P>> packed(tree.bodies);
    for (int i = 0; i < tree.bodies; ++i)
      for (int lane = 0; lane < kLanes; ++lane) {
        const auto put = [&](const auto& from, auto& to) {
          for (int a = 0; a < int(from.size()); ++a) to[a].v[lane] = from[a];
        };
        const JointJet<float>& jet = jets[lane][i];
        put(jet.rotation.coeffs(), packed[i].rotation.coeffs());
        put(jet.omega, packed[i].omega);
        put(jet.alpha, packed[i].alpha);
        put(jet.translation, packed[i].translation);
        put(jet.velocity, packed[i].velocity);
        put(jet.acceleration, packed[i].acceleration);
      }
    std::vector<BodyMotion<P>> pack_room(tree.bodies);
    std::vector<P> pack_torque(tree.dofs);
    residual_pass<P>(tree, packed, Vec3<P>(P(1), P(-2), P(-9)), pack_room, pack_torque);
    std::vector<BodyMotion<float>> room(tree.bodies);
    std::vector<float> torque(tree.dofs);
    for (int lane = 0; lane < kLanes; ++lane) {
      residual_pass<float>(tree, jets[lane], Vec3<float>(1, -2, -9), room, torque);
      for (int dof = 0; dof < tree.dofs; ++dof)
        EXPECT_EQ(pack_torque[dof].v[lane], torque[dof]) << "seed " << seed << " dof " << dof;
    }
  }
}

TEST(Pack, SelectsLaneByLaneAndNaNIsNeverMoreNorLess) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const P a = P(P::Vector{1, nan, 3, -0.f}), b = P(P::Vector{2, 2, 2, 0.f});
  const P less = select(a < b, P(1), P(0)), more = select(a > b, P(1), P(0)),
          at_least = select(a >= b, P(1), P(0)), equal = select(a == b, P(1), P(0));
  const float wanted[4][kLanes] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 1}};
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(less.v[lane], wanted[0][lane]);
    EXPECT_EQ(more.v[lane], wanted[1][lane]);
    EXPECT_EQ(at_least.v[lane], wanted[2][lane]);
    EXPECT_EQ(equal.v[lane], wanted[3][lane]);
  }
  EXPECT_TRUE(any(a < b));
  EXPECT_FALSE(any(both(a<b, a> b)));
}

TEST(Pack, LargestAndSmallestAreTheStandardLibrarysOfEveryLane) {
  const P a = P(P::Vector{1, -2, 5, 0.5f}), b = P(P::Vector{2, -3, 5, 0.25f});
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(largest(a, b).v[lane], std::max(a.v[lane], b.v[lane]));
    EXPECT_EQ(smallest(a, b).v[lane], std::min(a.v[lane], b.v[lane]));
  }
  EXPECT_EQ(largest(2.0, 3.0), 3.0);
}

}  // namespace
}  // namespace sinew
