#include "sinew/residual/tree.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "sinew/residual/residual_pass.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

namespace {

Mat3<double> pseudo_inverse(const Mat3<double>& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> axes(inertia);
  Vec3<double> inverse = Vec3<double>::Zero();
  for (int a = 0; a < 3; ++a)
    if (axes.eigenvalues()[a] > 1e-9 * axes.eigenvalues()[2]) inverse[a] = 1 / axes.eigenvalues()[a];
  return axes.eigenvectors() * inverse.asDiagonal() * axes.eigenvectors().transpose();
}

/// Columns: axes of a joint that do not move with its child, rest axes.
Mat3<double> held_by_parent(const Joint& joint) {
  Mat3<double> axes = Mat3<double>::Zero();
  if (joint.type == JointType::kUniversal) axes.col(0) = joint.axis;
  if (joint.type == JointType::kPlanar) {
    Vec3<double> a, b;
    planar_axes<double>(joint.axis, a, b);
    axes << a, b, joint.axis;
  }
  return axes;
}

}  // namespace

template <class T>
Tree<T>::Tree(const Skeleton& skeleton) : bodies(skeleton.body_count) {
  for (int i = 0; i < bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    parent.push_back(joint.parent);
    type.push_back(joint.type);
    first_dof.push_back(dofs);
    rest.push_back(joint.rest.cast<T>());
    axis.push_back(joint.axis.cast<T>());
    axis2.push_back(joint.axis2.cast<T>());
    mass.push_back(T(joint.mass));
    center_of_mass.push_back(joint.center_of_mass.cast<T>());
    inertia.push_back(joint.inertia.cast<T>());
    const Vec3<double>& c = joint.center_of_mass;
    first_moment.push_back((joint.mass * c).cast<T>());
    inertia_at_joint.push_back(
        (joint.inertia + joint.mass * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose()))
            .cast<T>());
    held_axes.push_back((joint.rest.rotation * held_by_parent(joint)).cast<T>());
    second_moment.push_back(
        (0.5 * joint.inertia.trace() * Mat3<double>::Identity() - joint.inertia).cast<T>());
    inverse_inertia.push_back(pseudo_inverse(joint.inertia).cast<T>());
    int above = -1;  // the last degree of freedom on the way down to this joint
    for (int p = joint.parent; p >= 0 && above < 0; p = skeleton.joints[p].parent)
      if (sinew::dof_count(skeleton.joints[p].type) > 0)
        above = first_dof[p] + sinew::dof_count(skeleton.joints[p].type) - 1;
    for (int k = 0; k < sinew::dof_count(joint.type); ++k) {
      dof_body.push_back(i);
      dof_parent.push_back(k == 0 ? above : dofs - 1);
      ++dofs;
    }
  }
  first_dof.push_back(dofs);
  std::vector<int> depth(bodies, 0);
  for (int i = 0; i < bodies; ++i)
    if (parent[i] >= 0) depth[i] = depth[parent[i]] + 1;
  by_depth.resize(bodies);
  std::iota(by_depth.begin(), by_depth.end(), 0);
  std::sort(by_depth.begin(), by_depth.end(),
            [&](int a, int b) { return depth[a] != depth[b] ? depth[a] < depth[b] : a < b; });
}

template <class T>
void forward_kinematics(const Tree<T>& tree, std::span<const Transform<T>> local,
                        const Vec3<T>& common_origin, Kinematics<T>& out) {
  place_bodies<T>(tree, local, common_origin, out);
}

template <class T>
Transform<T> displaced(const Tree<T>& tree, int i, const Transform<T>& local, const T* d) {
  return moved_by<T>(tree, i, local, d);
}

template <class T>
void project_wrenches(const Tree<T>& tree, const Kinematics<T>& k, std::span<Vec3<T>> force,
                      std::span<Vec3<T>> moment, std::span<T> projection) {
  sum_and_project<T>(tree, k, force, moment, projection);
}

template <class T>
void inertial_wrenches(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<T>& gravity,
                       const Vec3<T>& common_origin, Kinematics<T>& k, Motion<T>& m, std::span<Vec3<T>> force,
                       std::span<Vec3<T>> moment) {
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    const JointJet<T>& jet = jets[i];
    BodyMotion<T>& body = m.body[i];
    move_body<T>(tree, i, jet, gravity, p < 0 ? nullptr : &m.body[p], body);
    if (p < 0) {
      k.rotation[i] = body.turn;
      k.origin[i] = jet.translation - common_origin;
      m.origin_velocity[i] = jet.velocity;
    } else {
      const Mat3<T>& rp = k.rotation[p];
      k.rotation[i].noalias() = rp * body.turn;
      const Vec3<T> arm = rp * jet.translation;
      k.origin[i] = k.origin[p] + arm;
      m.origin_velocity[i] = m.origin_velocity[p] + m.omega[p].cross(arm) + rp * jet.velocity;
    }
    const Mat3<T>& r = k.rotation[i];
    const Vec3<T> arm = r * tree.center_of_mass[i];
    k.center[i] = k.origin[i] + arm;
    m.omega[i] = r * body.omega;
    m.velocity[i] = m.origin_velocity[i] + m.omega[i].cross(arm);
    motion_axes<T>(tree, i, Transform<T>{jet.rotation, jet.translation}, k);
    force[i] = r * body.force;
    moment[i] = r * body.moment + k.origin[i].cross(force[i]);
  }
}

SINEW_RESIDUAL_INSTANCES(template, float)
SINEW_RESIDUAL_INSTANCES(template, double)

}  // namespace sinew
