#include "sinew/residual/dynamics.h"

#include <limits>

#include "sinew/residual/composite.h"

namespace sinew {
namespace {

using V = Vec3<double>;

/// Local pose, velocity and acceleration of one joint at a state.
JointJet<double> joint_jet(const Joint& joint, const JointState& s) {
  JointJet<double> jet;
  jet.rotation = joint.rest.rotation;
  jet.translation = joint.rest.translation;
  const V v(s.v[0], s.v[1], s.v[2]), a(s.a[0], s.a[1], s.a[2]);
  switch (joint.type) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      jet.rotation = joint.rest.rotation * rotation_exp<double>(joint.axis * s.q[0]);
      jet.omega = joint.axis * s.v[0];
      jet.alpha = joint.axis * s.a[0];
      break;
    case JointType::kPrismatic: {
      const V axis = joint.rest.rotation * joint.axis;
      jet.translation += axis * s.q[0];
      jet.velocity = axis * s.v[0];
      jet.acceleration = axis * s.a[0];
      break;
    }
    case JointType::kUniversal: {
      const Quat<double> second = rotation_exp<double>(joint.axis2 * s.q[1]);
      const V first_axis = second.conjugate() * joint.axis;
      jet.rotation = joint.rest.rotation * rotation_exp<double>(joint.axis * s.q[0]) * second;
      jet.omega = first_axis * s.v[0] + joint.axis2 * s.v[1];
      jet.alpha =
          first_axis * s.a[0] + joint.axis2 * s.a[1] + (first_axis * s.v[0]).cross(joint.axis2 * s.v[1]);
      break;
    }
    case JointType::kBall:
      jet.rotation = joint.rest.rotation * s.rotation;
      jet.omega = v;
      jet.alpha = a;
      break;
    case JointType::kPlanar: {
      const V x = joint.axis.unitOrthogonal(), y = joint.axis.cross(x);
      const auto in_plane = [&](const double* c) { return V(joint.rest.rotation * (x * c[0] + y * c[1])); };
      jet.rotation = joint.rest.rotation * rotation_exp<double>(joint.axis * s.q[2]);
      jet.translation += in_plane(s.q);
      jet.velocity = in_plane(s.v);
      jet.acceleration = in_plane(s.a);
      jet.omega = joint.axis * s.v[2];
      jet.alpha = joint.axis * s.a[2];
      break;
    }
    case JointType::kFree:
      jet.rotation = s.rotation;
      jet.translation = s.position;
      jet.velocity = v;
      jet.acceleration = a;
      jet.omega = s.rotation.conjugate() * V(s.v[3], s.v[4], s.v[5]);
      jet.alpha = s.rotation.conjugate() * V(s.a[3], s.a[4], s.a[5]);
      break;
    case JointType::kTranslation:
      jet.translation += V(s.q[0], s.q[1], s.q[2]);
      jet.velocity = v;
      jet.acceleration = a;
      break;
  }
  return jet;
}

Eigen::VectorXd residual(const Tree<double>& tree, const std::vector<JointJet<double>>& jets,
                         const V& gravity, Kinematics<double>& kinematics, Motion<double>& motion) {
  std::vector<V> force(tree.bodies), moment(tree.bodies);
  inertial_wrenches<double>(tree, jets, gravity, V::Zero(), kinematics, motion, force, moment);
  Eigen::VectorXd torque(tree.dofs);
  project_wrenches<double>(tree, kinematics, force, moment, {torque.data(), std::size_t(tree.dofs)});
  return torque;
}

}  // namespace

DynamicsResult evaluate_dynamics(const Skeleton& skeleton, const std::vector<JointState>& states,
                                 const V& gravity) {
  const Tree<double> tree(skeleton);
  Kinematics<double> kinematics(tree);
  Motion<double> motion(tree);
  std::vector<JointJet<double>> jets;
  jets.reserve(tree.bodies);
  for (int i = 0; i < tree.bodies; ++i) jets.push_back(joint_jet(skeleton.joints[i], states[i]));

  DynamicsResult result;
  result.inverse_dynamics = residual(tree, jets, gravity, kinematics, motion);
  std::vector<Composite<double>> bodies(tree.bodies);
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<double>& r = kinematics.rotation[i];
    const Mat3<double> inertia = r * tree.inertia[i] * r.transpose();
    bodies[i].add_body(tree.mass[i], kinematics.center[i], inertia);
    result.total_mass += tree.mass[i];
    result.center_of_mass += tree.mass[i] * kinematics.center[i];
    result.kinetic_energy += 0.5 * tree.mass[i] * motion.velocity[i].squaredNorm() +
                             0.5 * motion.omega[i].dot(inertia * motion.omega[i]);
    result.potential_energy -= tree.mass[i] * gravity.dot(kinematics.center[i]);
  }
  if (result.total_mass > 0) result.center_of_mass /= result.total_mass;

  Unknowns all;
  append_unknowns<double>(tree, std::vector<std::uint8_t>(tree.dofs, 1), all);
  TreeMatrix<double> matrix(all.pattern);
  matrix.set_zero();
  PathAxes<double> axes;
  axes.append(tree, kinematics, all, 0);
  assemble_tree_matrix<double>(tree, kinematics, axes, bodies, all, 0, false, matrix);
  result.mass_matrix = Eigen::MatrixXd::Zero(tree.dofs, tree.dofs);
  for (int k = 0; k < tree.dofs; ++k)
    for (int l = k; l >= 0; l = all.pattern.parent[l])
      result.mass_matrix(k, l) = result.mass_matrix(l, k) = matrix.row(k)[all.pattern.depth[l]];

  // Bias: the residual at zero acceleration.
  std::vector<JointState> still = states;
  for (JointState& s : still) std::fill(std::begin(s.a), std::end(s.a), 0.0);
  for (int i = 0; i < tree.bodies; ++i) jets[i] = joint_jet(skeleton.joints[i], still[i]);
  Kinematics<double> scratch(tree);
  Motion<double> still_motion(tree);
  result.forward_dynamics = -residual(tree, jets, gravity, scratch, still_motion);
  if (matrix.factorise()) {
    matrix.solve({result.forward_dynamics.data(), std::size_t(tree.dofs)});
  } else {
    result.forward_dynamics.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  result.frames.resize(skeleton.joints.size());
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const Joint& joint = skeleton.joints[i];
    const Transform<double> local = static_cast<int>(i) < tree.bodies
                                        ? Transform<double>{jets[i].rotation, jets[i].translation}
                                        : joint.rest;
    result.frames[i] = joint.parent < 0 ? local : result.frames[joint.parent] * local;
  }
  return result;
}

}  // namespace sinew
