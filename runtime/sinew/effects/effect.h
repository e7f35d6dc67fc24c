// What every effect of a scene looks like to a step: wind, water, springs, … and the ones that you add (see
// README.md).
//
// An effect acts on one tree. Whoever declares it makes an object per character (World::add_effect); one with
// nothing to act on is not in the step's plan, and the object file of one that nobody declares is not linked.
// Everything is called on the thread that steps the tree; nothing may allocate after attach().
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sinew/muscle/joint_rows.h"
#include "sinew/residual/spatial_stiffness.h"
#include "sinew/residual/tree.h"
#include "sinew/skeleton/status.h"

namespace sinew {

/// Where a tree is within a step. Positions are relative to the common origin, axes are the world's.
template <class T>
struct EffectPose {
  const Tree<T>& tree;                  ///< that the effect acts on
  const Kinematics<T>& kinematics;      ///< at this pose
  std::span<const Transform<T>> local;  ///< [body] joint → parent, now
  std::span<const Transform<T>> start;  ///< [body] when the step began
  Vec3<double> common_origin;           ///< world, m
  Vec3<T> gravity;                      ///< m/s²
  T h = T(0);                           ///< s

  /// A body's material point, given in its axes.
  Vec3<T> point(int body, const Vec3<T>& at) const {
    return kinematics.origin[body] + kinematics.rotation[body] * at;
  }
};

/// Sums of gradients by the bodies' motion; N and N·m about the common origin. A force is a negative
/// gradient.
template <class T>
struct Wrenches {
  std::span<Vec3<T>> force;   ///< [body] N
  std::span<Vec3<T>> moment;  ///< [body] N·m

  /// The gradient by the material point at x.
  void add(int body, const Vec3<T>& x, const Vec3<T>& gradient) const {
    force[body] += gradient;
    moment[body] += x.cross(gradient);
  }
};

/// Where second derivatives go.
template <class T>
struct Curvature {
  std::span<Composite<T>> composite;         ///< [body]
  std::span<SpatialStiffness<T>> stiffness;  ///< [body]
  bool& stiff;                               ///< something was added to `stiffness`

  /// At the material point x: the gradient there, for what turning the body does to it, and how it changes
  /// with x; `change` must be positive semidefinite.
  void add(int body, const Vec3<T>& x, const Vec3<T>& gradient, const Mat3<T>& change) const {
    composite[body].add_force(x, gradient);
    stiffness[body].add_point(x, change);
    stiff = true;
  }
};

/// Something that acts on one tree. Every effect overrides attach(), instances() and bytes(); one that is an
/// energy of the pose add_gradient(), add_curvature() and add_load(); one of single joints add_rows() and
/// most_rows().
template <class T>
class Effect {
 public:
  virtual ~Effect() = default;

  /// Set-up on the tree that it will act on. The only place to allocate.
  virtual Status attach(const Skeleton& skeleton, const Tree<T>& tree) = 0;
  /// How many things it acts on there; 0 leaves it out of the plan.
  virtual int instances() const = 0;

  /// Measures at the start of a step what stays fixed within it.
  virtual void begin_step(const EffectPose<T>& /*start*/) {}
  /// Energy (J) at a pose that may end the step, its gradient by points of the bodies added to `out`.
  /// Dissipation is the potential of the step, h·D((x₁ − x₀)/h): its gradient is the drag.
  virtual double add_gradient(const EffectPose<T>& /*pose*/, const Wrenches<T>& /*out*/) const { return 0; }
  /// Second derivative of the same, at the same pose.
  virtual void add_curvature(const EffectPose<T>& /*pose*/, const Curvature<T>& /*out*/) const {}
  /// Or energies of single joints, as rows: added to the problem where the joint is solved for, and to what
  /// its muscles must bear where it is not.
  virtual void add_rows(const EffectPose<T>& /*pose*/, std::vector<JointRow<T>>& /*out*/) const {}
  /// At most so many rows.
  virtual int most_rows() const { return 0; }
  /// Gradient that a tree on its animation feels, whose velocities are known: what its muscles must bear.
  /// Rows are taken into account without it.
  virtual void add_load(const EffectPose<T>& /*pose*/, const Motion<T>& /*motion*/,
                        const Wrenches<T>& /*out*/) const {}
  /// It never gives energy to the tree, whatever happens.
  virtual bool passive() const { return false; }
  /// Memory, all told.
  virtual std::size_t bytes() const = 0;
};

/// The simulated joints with these names, or all of them where there are none; 0 … bodies − 1. Answers an
/// error for a name that is no simulated joint's, with its place in the list.
Status bodies_named(const Skeleton& skeleton, std::span<const std::string> names, std::vector<int>& out);

}  // namespace sinew
