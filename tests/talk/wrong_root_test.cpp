// "Limitations: finding the wrong root. … In order for this to be a problem at a 60 Hz simulation rate, you
// have to encounter angular accelerations that are ~ 3600 radians/second²": where a load turns a lever by
// more than a radian per step and step.
#include <gtest/gtest.h>

#include <numbers>

#include "fixtures/standard_plan.h"
#include "sinew/optimizer/problem.h"
#include "study/schemes/schemes.h"

namespace sinew::study {
namespace {

constexpr double kStep = 1 / 60.0, kArm = 0.36, kLoad = 100;

/// An upright lever that a load stands on, and what a step asks of it at any angle.
struct Lever {
  Skeleton skeleton;
  Tree<double> tree;
  TreeProblem<double> problem;
  StepSettings<double> settings;

  static Skeleton lever(double inertia) {
    Skeleton s;
    s.body_count = 1;
    Joint& joint = s.joints.emplace_back();
    joint.type = JointType::kRevolute;
    joint.axis = Vec3<double>::UnitY();
    joint.mass = 1;
    joint.inertia = inertia * Mat3<double>::Identity();
    for (DofLimits& dof : joint.dofs) dof.dry_friction = 0;
    return s;
  }

  /// `acceleration`: rad/s², of the load times its arm on the lever's inertia.
  Lever(double acceleration, const TimeScheme<double>& scheme)
      : skeleton(lever(kLoad * kArm / acceleration)), tree(skeleton), problem(tree, skeleton) {
    settings.plan = &standard_plan<double>();
    settings.h = kStep;
    settings.gravity.setZero();
    problem.free.assign(1, 1);
    problem.start = problem.local = problem.target = tree.rest;
    problem.pushes.push_back({0, {0, 0, kArm}, {0, 0, -kLoad}});
    History<double> at_rest(1);
    scheme.predict(tree, at_rest, kStep, Vec3<double>::Zero(), problem.prediction);
  }
  /// N·m, at an angle from upright.
  double residual(double angle) {
    problem.local[0] = displaced<double>(tree, 0, tree.rest[0], &angle);
    begin_evaluation(settings, problem);
    finish_gradient(problem);
    return problem.gradient[0];
  }
  /// How many angles within half a turn from upright solve the step such that it would come back to them.
  int stable_roots() {
    constexpr int kParts = 720;
    int count = 0;
    const auto angle = [](int n) { return std::numbers::pi * (2 * (n + 0.5) / kParts - 1); };
    for (int n = 0; n + 1 < kParts; ++n) count += residual(angle(n)) < 0 && residual(angle(n + 1)) >= 0;
    return count;
  }
  double slope_upright() { return (residual(1e-4) - residual(-1e-4)) / 2e-4; }
};

TEST(WrongRoot, TalksResidualHasOneRootBelow3600RadPerSecondSquaredAndMoreAbove) {
  const Momentum<double> talk;
  for (const double acceleration : {900.0, 1800.0, 3590.0})
    EXPECT_EQ(Lever(acceleration, talk).stable_roots(), 1) << acceleration;
  // Above, the lever falls to either side within the step, and upright is no solution any more.
  for (const double acceleration : {3700.0, 7200.0, 14400.0})
    EXPECT_EQ(Lever(acceleration, talk).stable_roots(), 2) << acceleration;
}

TEST(WrongRoot, IncrementalPotentialHasOneMinimumThatFlipsThere) {
  const Bdf1<double> euler;
  for (const double acceleration : {900.0, 1800.0, 3590.0}) {
    Lever lever(acceleration, euler);
    EXPECT_GT(lever.slope_upright(), 0) << acceleration << ": upright is a minimum";
    EXPECT_EQ(lever.stable_roots(), 1) << acceleration;
  }
  for (const double acceleration : {3610.0, 7200.0, 14400.0}) {
    Lever lever(acceleration, euler);
    EXPECT_LT(lever.slope_upright(), 0) << acceleration << ": upright is a maximum";
    EXPECT_EQ(lever.stable_roots(), 0) << acceleration << ": the one minimum is upside down, at π itself";
  }
}

}  // namespace
}  // namespace sinew::study
