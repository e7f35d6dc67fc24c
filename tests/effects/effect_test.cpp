// Every effect's gradient and second derivative against differences, and what its load says about muscles.
#include "sinew/effects/effect.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "residual/random_tree.h"
#include "sinew/effects/buoyancy.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/wind.h"
#include "sinew/optimizer/problem.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Eigen::VectorXd;
using fixtures::Random;

struct Kind {
  const char* name;
  std::function<std::unique_ptr<Effect<double>>()> make;
  bool convex_in_points;  ///< its matrix is the whole second derivative
};

std::vector<Kind> kinds() {
  WindSettings gale;
  gale.velocity = {14, -9, 3};
  BuoyancySettings pool;
  pool.level = 0.6;
  pool.flow = {1, 0.5, 0};
  JointSpringSettings spring;
  spring.stiffness = 40;
  spring.damping = 3;
  spring.rest = {0.2, -0.1, 0.3};
  ForceFieldSettings pull;
  pull.center = {1, 2, 0};
  pull.acceleration = 20;
  return {{"wind", [=] { return std::make_unique<Wind<double>>(gale); }, true},
          {"buoyancy", [=] { return std::make_unique<Buoyancy<double>>(pool); }, true},
          {"joint_spring", [=] { return std::make_unique<JointSpring<double>>(spring); }, false},
          {"force_field", [=] { return std::make_unique<ForceField<double>>(pull); }, true}};
}

/// A random tree with colliders of every shape near the water's surface. Bodies are so light that the effect
/// is what a difference quotient sees.
struct Scene {
  Skeleton skeleton;
  Tree<double> tree;
  TreeProblem<double> problem;
  StepSettings<double> settings;
  std::unique_ptr<Effect<double>> effect;

  Scene(unsigned seed, const Kind& kind)
      : skeleton(clothed(seed)), tree(skeleton), problem(tree, skeleton), effect(kind.make()) {
    Random random(seed + 500);
    problem.common_origin = settings.common_origin = {0.4, -0.3, 0.5};
    problem.start = fixtures::random_pose(tree, random, 0.3);
    VectorXd d(tree.dofs);
    for (double& x : d) x = random.normal(0.05);
    problem.local = fixtures::displaced_pose(tree, problem.start, d.data());
    std::fill(problem.free.begin(), problem.free.end(), std::uint8_t{1});
    EXPECT_TRUE(effect->attach(skeleton, tree).ok());
    problem.plan(*effect);
    forward_kinematics<double>(tree, problem.start, problem.common_origin, problem.kinematics);
    effect->begin_step({tree, problem.kinematics, problem.start, problem.start, problem.common_origin,
                        settings.gravity, settings.h});
    problem.prediction.weight = 0;  // no inertia, no gravity: only the effect
    settings.gravity = V::Zero();
  }
  static Skeleton clothed(unsigned seed) {
    Skeleton s = fixtures::random_skeleton(seed);
    Random random(seed + 700);
    for (int i = 0; i < s.body_count; ++i) {
      Collider c;
      c.joint = i;
      c.shape = static_cast<Shape>(i % 3);
      c.local = {random.rotation(), random.vector(0.1)};
      c.size = {0.08, 0.12, 0.2};
      s.colliders.push_back(c);
    }
    return s;
  }
  double energy() { return begin_evaluation(settings, problem); }
  VectorXd gradient() {
    energy();
    finish_gradient(problem);
    return VectorXd::Map(problem.gradient.data(), tree.dofs);
  }
};

class EveryEffect : public testing::TestWithParam<unsigned> {};

TEST_P(EveryEffect, GradientIsTheDerivativeOfItsEnergy) {
  for (const Kind& kind : kinds()) {
    Scene s(GetParam(), kind);
    const VectorXd gradient = s.gradient();
    ASSERT_GT(gradient.norm(), 1) << kind.name;
    const auto base = s.problem.local;
    constexpr double step = 1e-6;  // rounding: 1e-16·(1e3 J)/1e-6 = 1e-7; forces are of the order of 1e2
    for (int k = 0; k < s.tree.dofs; ++k) {
      VectorXd d = VectorXd::Unit(s.tree.dofs, k) * step;
      s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
      const double ahead = s.energy();
      d = -d;
      s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
      const double behind = s.energy();
      EXPECT_NEAR((ahead - behind) / (2 * step), gradient[k], 1e-6 * gradient.norm())
          << kind.name << " dof " << k;
    }
  }
}

TEST_P(EveryEffect, CurvatureIsTheSecondDerivative) {
  for (const Kind& kind : kinds()) {
    if (!kind.convex_in_points) continue;  // rows: Problem.EveryRowsGradient… checks theirs
    Scene s(GetParam(), kind);
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
    std::vector<double> path(TreePattern::padded(n));
    assemble_tree_matrix<double>(s.tree, s.problem.kinematics, axes, s.problem.composite, all, first, true,
                                 matrix);
    add_stiffness<double>(s.tree, s.problem.kinematics, axes, s.problem.stiffness, all, first, path, matrix);
    Eigen::MatrixXd difference(n, n);
    constexpr double step = 1e-5;
    const auto in_chart = [&](const VectorXd& d) {
      s.problem.local = fixtures::displaced_pose(s.tree, base, d.data());
      VectorXd g = s.gradient();
      for (int i = 0; i < s.tree.bodies; ++i)
        if (const int r = fixtures::rotation_vector_dof(s.tree, i); r >= 0)
          g.segment<3>(r) =
              (fixtures::chart_jacobian(s.tree, i, V(d.segment<3>(r))).transpose() * g.segment<3>(r)).eval();
      return g;
    };
    for (int k = 0; k < n; ++k) {
      const VectorXd e = VectorXd::Unit(n, k) * step;
      difference.col(k) = (in_chart(e) - in_chart(-e)) / (2 * step);
    }
    const double scale = difference.norm();
    ASSERT_GT(scale, 1) << kind.name;
    for (int k = 0; k < n; ++k)
      for (int l = k; l >= 0; l = all.pattern.parent[l])
        EXPECT_NEAR(matrix.row(k)[all.pattern.depth[l]], difference(k, l), 1e-6 * scale)
            << kind.name << " dofs " << k << " and " << l;
  }
}

TEST_P(EveryEffect, LoadOfAMovingCharacterIsTheGradientAtTheSameSpeed) {
  for (const Kind& kind : kinds()) {
    Scene s(GetParam(), kind);
    // A step so short that its chords are the velocities: the difference shrinks with h·acceleration.
    s.settings.h = 1e-5;
    std::vector<JointJet<double>> jets(s.tree.bodies);
    Random random(GetParam() + 1);
    for (int i = 0; i < s.tree.bodies; ++i) {
      jets[i].rotation = s.problem.start[i].rotation;
      jets[i].translation = s.problem.start[i].translation;
      jets[i].omega = random.vector(2);
      jets[i].velocity = random.vector(1);
    }
    Kinematics<double> kinematics(s.tree);
    Motion<double> motion(s.tree);
    std::vector<V> force(s.tree.bodies), moment(s.tree.bodies);
    inertial_wrenches<double>(s.tree, jets, V::Zero(), s.problem.common_origin, kinematics, motion, force,
                              moment);
    for (int i = 0; i < s.tree.bodies; ++i) {
      force[i] = moment[i] = V::Zero();
      s.problem.local[i].rotation = jets[i].rotation * rotation_exp<double>(s.settings.h * jets[i].omega);
      s.problem.local[i].translation = jets[i].translation + s.settings.h * jets[i].velocity;
    }
    s.settings.gravity = {0, 0, -9.81};
    forward_kinematics<double>(s.tree, s.problem.start, s.problem.common_origin, s.problem.kinematics);
    const EffectPose<double> start{s.tree,
                                   kinematics,
                                   s.problem.start,
                                   s.problem.start,
                                   s.problem.common_origin,
                                   s.settings.gravity,
                                   s.settings.h};
    s.effect->begin_step(start);
    s.effect->add_load(start, motion, {force, moment});
    std::vector<V> force_in_step(s.tree.bodies, V::Zero()), moment_in_step = force_in_step;
    forward_kinematics<double>(s.tree, s.problem.local, s.problem.common_origin, s.problem.kinematics);
    s.effect->add_gradient(effect_pose(s.settings, s.problem), {force_in_step, moment_in_step});
    for (int i = 0; i < s.tree.bodies; ++i) {
      EXPECT_LT((force[i] - force_in_step[i]).norm(), 1e-3 * (1 + force[i].norm())) << kind.name << i;
      EXPECT_LT((moment[i] - moment_in_step[i]).norm(), 1e-3 * (1 + moment[i].norm())) << kind.name << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EveryEffect, testing::Values(1u, 2u, 3u));

TEST(Effect, RefusesAJointThatIsNotThere) {
  const Skeleton s = fixtures::random_skeleton(1);
  const Tree<double> tree(s);
  WindSettings settings;
  settings.joints = {"joint2", "tail"};
  Wind<double> wind(settings);
  const Status status = wind.attach(s, tree);
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(status.index, 1);
}

TEST(Effect, WithoutInstancesIsNotInThePlan) {
  const Skeleton bare = fixtures::random_skeleton(1);  // no colliders
  const Tree<double> tree(bare);
  TreeProblem<double> problem(tree, bare);
  Wind<double> wind{WindSettings{}};
  ASSERT_TRUE(wind.attach(bare, tree).ok());
  problem.plan(wind);
  EXPECT_TRUE(problem.effects.empty());
  EXPECT_TRUE(problem.stiffness.empty());
}

}  // namespace
}  // namespace sinew
