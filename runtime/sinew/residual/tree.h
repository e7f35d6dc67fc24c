// A skeleton's simulated joints as flat arrays, and the two recursions that everything else is made of.
//
// All spatial quantities of a tree refer to ONE common origin (near the character, so that float keeps its
// digits far from the world's): a motion is (w, v) with v the velocity of the material point at that origin,
// so the velocity at x is v + w × x, and every accumulation along the tree is a plain addition. Axes are the
// world's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/residual/scale.h"
#include "sinew/skeleton/rotation.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Constant data of the simulated joints, one entry per body or degree of freedom, parents first.
template <class T>
struct Tree {
  int bodies = 0;
  int dofs = 0;
  std::vector<int> parent;      ///< [body]
  std::vector<JointType> type;  ///< [body]
  std::vector<int> by_depth;    ///< bodies, those near the root first: neighbours do not wait for each other
  std::vector<int> first_dof;   ///< [body + 1]
  std::vector<int> dof_body;    ///< [dof]
  std::vector<int> dof_parent;  ///< [dof] next degree of freedom towards the root, or -1
  std::vector<Transform<T>> rest;         ///< [body]
  std::vector<Vec3<T>> axis, axis2;       ///< [body] child axes
  std::vector<T> mass;                    ///< [body] kg
  std::vector<Vec3<T>> center_of_mass;    ///< [body] joint axes
  std::vector<Mat3<T>> inertia;           ///< [body] about the centre of mass, joint axes
  std::vector<Vec3<T>> first_moment;      ///< [body] mass · centre of mass, joint axes, kg·m
  std::vector<Mat3<T>> inertia_at_joint;  ///< [body] about the joint's origin, joint axes
  std::vector<Mat3<T>> parent_axes;    ///< [body] columns: axes that stay with the parent, in its axes: the
                                       ///< first of a universal joint, all of a planar one
  std::vector<Mat3<T>> second_moment;  ///< [body] P = ½ tr(I)·1 − I

  Scale<T> scale;  ///< that its settings and thresholds are given in

  std::vector<Mat3<T>> inverse_inertia;  ///< [body] pseudo-inverse: a thin rod's is zero along its axis

  explicit Tree(const Skeleton& skeleton);
  int dof_count(int body) const { return first_dof[body + 1] - first_dof[body]; }
};

/// Where the bodies are, and along which spatial axes each degree of freedom moves its subtree.
template <class T>
struct Kinematics {
  std::vector<Mat3<T>> rotation;  ///< [body] body → world
  std::vector<Vec3<T>> origin;    ///< [body] joint origin, from the common origin
  std::vector<Vec3<T>> center;    ///< [body] centre of mass, from the common origin
  std::vector<Vec3<T>> w, v;      ///< [dof] motion axes

  explicit Kinematics(const Tree<T>& tree)
      : rotation(tree.bodies), origin(tree.bodies), center(tree.bodies), w(tree.dofs), v(tree.dofs) {}
};

/// Root → leaves: poses and motion axes at the local transforms `local` [body]. O(bodies).
/// `common_origin` (world, m) is subtracted from every position.
template <class T>
void forward_kinematics(const Tree<T>& tree, std::span<const Transform<T>> local,
                        const Vec3<T>& common_origin, Kinematics<T>& out);

/// Moves joint `body` by d, its degrees of freedom in the chart centred at `local`:
/// ball local·exp(d); free translation + d, exp(d)·rotation; revolute local·exp(axis·d); …
template <class T>
Transform<T> displaced(const Tree<T>& tree, int body, const Transform<T>& local, const T* d);

/// Leaves → root: sums wrenches (force, moment about the common origin) over subtrees and projects them on
/// the motion axes: `projection`[dof] = w·moment + v·force. `force` and `moment` are overwritten by the
/// subtree sums.
template <class T>
void project_wrenches(const Tree<T>& tree, const Kinematics<T>& kinematics, std::span<Vec3<T>> force,
                      std::span<Vec3<T>> moment, std::span<T> projection);

/// One body on the way through the residual pass (residual_pass.h). Vectors in its own axes unless said.
template <class T>
struct BodyMotion {
  Mat3<T> turn;          ///< body → parent
  Vec3<T> arm;           ///< joint origin, parent axes
  Vec3<T> omega, alpha;  ///< rad/s, rad/s²
  Vec3<T> acceleration;  ///< of the joint origin, less gravity
  Vec3<T> force;         ///< that the motion asks for
  Vec3<T> moment;        ///< about the joint origin
};

/// How the bodies move under joint jets.
template <class T>
struct Motion {
  std::vector<BodyMotion<T>> body;       ///< [body]
  std::vector<Vec3<T>> omega;            ///< [body] rad/s, world axes
  std::vector<Vec3<T>> velocity;         ///< [body] of the centre of mass, world axes
  std::vector<Vec3<T>> origin_velocity;  ///< [body] of the joint origin

  explicit Motion(const Tree<T>& tree)
      : body(tree.bodies), omega(tree.bodies), velocity(tree.bodies), origin_velocity(tree.bodies) {}
};

/// Recursive residual pass of the seed talk, in its continuous form (residual_pass.h), for those who also
/// want to know where everything is: what every joint's motion (`jets` [body], any motion, also across the
/// joint's own axes) asks of its muscles. Writes kinematics, motion, and the wrench per body that the inertia
/// and gravity call for (minus nothing else: subtract external wrenches before project_wrenches). O(bodies).
template <class T>
void inertial_wrenches(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<T>& gravity,
                       const Vec3<T>& common_origin, Kinematics<T>& kinematics, Motion<T>& motion,
                       std::span<Vec3<T>> force, std::span<Vec3<T>> moment);

#define SINEW_RESIDUAL_INSTANCES(prefix, T)                                                        \
  prefix struct Tree<T>;                                                                           \
  prefix void forward_kinematics<T>(const Tree<T>&, std::span<const Transform<T>>, const Vec3<T>&, \
                                    Kinematics<T>&);                                               \
  prefix Transform<T> displaced<T>(const Tree<T>&, int, const Transform<T>&, const T*);            \
  prefix void project_wrenches<T>(const Tree<T>&, const Kinematics<T>&, std::span<Vec3<T>>,        \
                                  std::span<Vec3<T>>, std::span<T>);
SINEW_RESIDUAL_INSTANCES(extern template, float)
SINEW_RESIDUAL_INSTANCES(extern template, double)

#define SINEW_WRENCH_INSTANCES(prefix, T)                                                          \
  prefix void inertial_wrenches<T>(const Tree<T>&, std::span<const JointJet<T>>, const Vec3<T>&,   \
                                   const Vec3<T>&, Kinematics<T>&, Motion<T>&, std::span<Vec3<T>>, \
                                   std::span<Vec3<T>>);
SINEW_WRENCH_INSTANCES(extern template, float)
SINEW_WRENCH_INSTANCES(extern template, double)

}  // namespace sinew
