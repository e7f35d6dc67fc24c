// What stands in a recorded scene: rigid bodies with masses and shapes, and how a member's bodies hang
// together.
#pragma once

#include <span>
#include <vector>

#include "study/audit/solid.h"

namespace sinew::audit {

struct Body {
  double mass = 0;                                    ///< kg
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   ///< of mass, in its own axes, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about it, own axes, kg·m²
  JointType type = JointType::kFree;                  ///< of the joint that it hangs on
  int parent = -1;                                    ///< body of the same member; -1: the world
  Transform<double> rest;                             ///< → parent, where the joint is at zero
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    ///< as Joint::axis
  Eigen::Vector3d axis2 = Eigen::Vector3d::UnitX();   ///< as Joint::axis2
  int first_dof = 0;                                  ///< of the member
  std::vector<Solid> solids;                          ///< in its own axes
};

/// A character or a loose thing.
struct Member {
  std::vector<Body> bodies;
  int dofs = 0;
  bool touches_ground = true;
  bool touches_itself = false;  ///< bodies that neither neighbour nor overlap at rest
};

Member member_of(const Skeleton& skeleton);
/// A homogeneous solid; `size` as Collider::size.
Member loose_solid(Shape shape, const Eigen::Vector3d& size, double mass, const ConvexHull* hull = nullptr);

using Poses = std::span<const Transform<double>>;  ///< [body of a member] body → world

/// A member's solids where its bodies stand; `bodies`, if not null, says whose each is.
std::vector<Solid> placed(const Member& member, Poses poses, std::vector<int>* bodies = nullptr);

/// How far joints stand open: where the two halves of one are apart, and by how much the axes that they share
/// point apart; beyond what poses explain that are rounded to `precision` of their size.
struct Gap {
  double distance = 0;  ///< m
  double angle = 0;     ///< rad
};
Gap joint_gap(const Member& member, Poses poses, double precision = 0);

Eigen::Vector3d center_of_mass(const Member& member, Poses poses);

/// Static solids, and the floor.
struct Surroundings {
  std::vector<Solid> obstacles;
  bool ground = false;
  double ground_height = 0;  ///< m
};
/// m, deepest that a member lies in them.
double depth_in(const Surroundings& around, const Member& member, Poses poses);
/// m, deepest that two members lie in each other.
double depth_between(const Member& a, Poses at_a, const Member& b, Poses at_b);
/// m, at least so far are two members apart; negative: so deep in each other.
double distance_between(const Member& a, Poses at_a, const Member& b, Poses at_b);
/// m, deepest that any two of them lie in each other; [member] poses. By a sweep along x: O(n log n) for n
/// solids that are spread out. What touches itself is looked at too.
double deepest_between(std::span<const Member> members, std::span<const Poses> poses);

}  // namespace sinew::audit
