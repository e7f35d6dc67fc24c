#include "sinew/residual/tree.h"

#include <algorithm>
#include <numeric>

#include "sinew/residual/tree_pass.h"
#include "sinew/skeleton/principal_axes.h"

namespace sinew {

namespace {

Mat3<double> pseudo_inverse(const Mat3<double>& inertia) {
  const auto [moments, axes] = principal_axes(inertia);
  Vec3<double> inverse = Vec3<double>::Zero();
  for (int a = 0; a < 3; ++a)
    if (moments[a] > 1e-9 * moments[2]) inverse[a] = 1 / moments[a];
  return axes * inverse.asDiagonal() * axes.transpose();
}

/// Columns: axes of a joint that do not move with its child, rest axes.
Mat3<double> axes_of_parent(const Joint& joint) {
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
  const Scale<double> in_double = scale_of(skeleton);
  scale = {T(in_double.length), T(in_double.time), T(in_double.energy), T(in_double.load)};
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
    parent_axes.push_back((joint.rest.rotation * axes_of_parent(joint)).cast<T>());
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

SINEW_RESIDUAL_INSTANCES(template, float)
SINEW_RESIDUAL_INSTANCES(template, double)

}  // namespace sinew
