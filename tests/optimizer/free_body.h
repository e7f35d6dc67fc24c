// One free body that schemes of the step are tried on.
#pragma once

#include <gtest/gtest.h>

#include "fixtures/standard_plan.h"
#include "sinew/optimizer/newton.h"

namespace sinew::fixtures {

using V = Vec3<double>;

inline const V kPrincipal(0.02, 0.05, 0.06);  // kg·m², unsymmetric: spin about the middle axis tumbles

inline Skeleton one_body() {
  Skeleton s;
  s.body_count = 1;
  Joint& joint = s.joints.emplace_back();
  joint.type = JointType::kFree;
  joint.mass = 2;
  joint.center_of_mass = {0.1, -0.05, 0.02};  // the root is not the centre of mass
  joint.inertia = kPrincipal.asDiagonal();
  return s;
}

/// What a step needs: predict into `problem`, minimise(), advance `history`.
struct FreeBody {
  Skeleton skeleton = one_body();
  Tree<double> tree{skeleton};
  TreeProblem<double> problem{tree, skeleton};
  History<double> history{1};
  NewtonSolver<double> solver;
  StepSettings<double> settings;
  Accuracy accuracy;

  FreeBody(const V& omega, const V& velocity, const V& gravity) {
    accuracy.tolerance = 1e-10;
    settings.plan = &standard_plan<double>();
    settings.gravity = gravity;
    solver.declare(*settings.plan);
    solver.reserve(problem.capacity);
    problem.free.assign(6, 1);
    Motion<double> motion(tree);
    JointJet<double> jet;
    jet.omega = omega;
    jet.velocity = velocity;
    std::vector<V> force(1), moment(1);
    inertial_wrenches<double>(tree, {&jet, 1}, V::Zero(), V::Zero(), problem.kinematics, motion, force,
                              moment);
    advance_exactly<double>(tree, problem.kinematics, motion, 0.0, V::Zero(), V::Zero(), history);
  }
  void minimise(double h) {
    settings.h = h;
    TreeProblem<double>* const trees[] = {&problem};
    EXPECT_TRUE(solver.solve(settings, accuracy, trees, {}).converged);
  }
};

}  // namespace sinew::fixtures
