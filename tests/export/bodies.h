// A body with a joint of every type, and states to compare dynamics in.
#pragma once

#include <random>

#include "sinew/residual/dynamics.h"

namespace sinew::exporting::test {

/// A chain below a free or bolted root. Every joint's frame is turned and off its parent's, every body has an
/// inertia with no axis along the joint's.
inline Skeleton chain_of_all_joints(JointType root) {
  Skeleton s;
  s.name = "chain";
  for (const JointType type :
       {root, JointType::kRevolute, JointType::kUniversal, JointType::kBall, JointType::kPrismatic,
        JointType::kFixed, JointType::kPlanar, JointType::kTranslation}) {
    const int i = static_cast<int>(s.joints.size());
    Joint& joint = s.joints.emplace_back();
    joint.name = "part " + std::to_string(i);
    joint.parent = i - 1;
    joint.type = type;
    const Vec3<double> place(0.1, 0.2 + 0.05 * i, -0.3);
    if (i > 0) joint.rest = {Quat<double>(0.9, 0.1 * i, -0.2, 0.3).normalized(), place};
    joint.axis = Vec3<double>(1, 2, -0.5 * i).normalized();
    joint.axis2 = joint.axis.unitOrthogonal();
    joint.mass = 1 + 0.3 * i;
    joint.center_of_mass = {0.02, -0.03, 0.01 * i};
    const Mat3<double> turn = Quat<double>(0.8, 0.3, -0.4, 0.1 * i).normalized().toRotationMatrix();
    joint.inertia = turn * Vec3<double>(0.02, 0.03, 0.04 + 1e-3 * i).asDiagonal() * turn.transpose();
    joint.inertia = 0.5 * (joint.inertia + joint.inertia.transpose()).eval();
    for (int k = 0; k < dof_count(type) && type != JointType::kFree; ++k) {
      joint.dofs[k].lower = -1 - 0.1 * k;
      joint.dofs[k].upper = 1.5;
      joint.dofs[k].torque_minus = joint.dofs[k].torque_plus = 10 + i;
      joint.dofs[k].damping = 0.5;
      joint.dofs[k].dry_friction = 0.1;
    }
  }
  s.body_count = static_cast<int>(s.joints.size());
  Joint& finger = s.joints.emplace_back();
  finger.name = "finger";
  finger.parent = s.body_count - 1;
  finger.rest.translation = {0, 0, 0.1};
  const Transform<double> along{Quat<double>(0.6, 0, 0.8, 0), {0.1, 0, 0}};
  s.colliders = {{1, Shape::kSphere, {}, Vec3<double>::Constant(0.06), 0.7},
                 {2, Shape::kCapsule, along, {0.03, 0.03, 0.12}, 0.8},
                 {3, Shape::kBox, along, {0.1, 0.04, 0.02}, 0.8}};
  s.muscles = {{"extra", "", 1, 0, 5, 2}};
  return s;
}

inline std::vector<JointState> random_states(const Skeleton& s, std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  std::vector<JointState> states(static_cast<std::size_t>(s.body_count));
  for (JointState& state : states) {
    for (double& q : state.q) q = normal(random);
    state.rotation =
        Quat<double>(normal(random), normal(random), normal(random), normal(random)).normalized();
    state.position = {normal(random), normal(random), normal(random)};
  }
  return states;
}

}  // namespace sinew::exporting::test
