// Work of what acts on a recorded character: torques of its joints, loads, and impulses that act at once.
#pragma once

#include <span>

#include "study/audit/member.h"

namespace sinew::audit {

/// How far a joint went along its degrees of freedom from one pose of parent and child to another, in the
/// order and axes of Skeleton's joint types (m and rad). `parent` is the identity where the world is.
void joint_way(const Body& body, const Transform<double>& parent_before, const Transform<double>& before,
               const Transform<double>& parent_after, const Transform<double>& after, std::span<double> way);

/// J. Torques (N·m, or N; [dof of the member]) held while it went from one pose to the other.
double work_of_torques(const Member& member, Poses before, Poses after, std::span<const double> torques);

struct PointImpulse {
  int body = 0;
  Eigen::Vector3d point, impulse;                   ///< world; m, N·s
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();  ///< m/s, of the point before it
};

/// J. Impulses on one member at the same instant, J·v + ½ J·M⁻¹·J, its joints free but for the root's where
/// that is driven. The mass matrix is summed up body by body and solved as it is. O(n³).
double work_of_impulses(const Member& member, Poses poses, bool root_is_driven,
                        std::span<const PointImpulse> impulses);

}  // namespace sinew::audit
