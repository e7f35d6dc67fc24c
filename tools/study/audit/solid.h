// Shapes where they stand, and by how much they lie in each other. Geometry of the studies' own: it shares no
// code with the runtime.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sinew/skeleton/convex_hull.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::audit {

/// A ball, capsule (segment along its own z), box or convex solid where it stands in the world.
struct Solid {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< m: half extents of a box; z: half a capsule's segment
  double radius = 0;                               ///< m; 0 of boxes
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3d> corners;  ///< m, of who is convex, in its own axes
};

Eigen::Isometry3d isometry(const Transform<double>& from);

/// `size` as Collider::size.
Solid solid_of(Shape shape, const Eigen::Vector3d& size, const Eigen::Isometry3d& pose);
Solid solid_of(const ConvexHull& hull, const Eigen::Isometry3d& pose);
Solid solid_of(const Collider& collider);

/// m, by how much two solids lie in each other; negative: at least so far apart. Exact but for a capsule
/// whose segment goes through a box (the depth of its deepest point) and boxes that are apart; where one is
/// convex by directions, to a few tenths of a millimetre where they lie deep in each other.
double overlap(const Solid& a, const Solid& b);
/// m, below a floor at `height`.
double below(const Solid& solid, double height);
/// m, radius of the ball about its middle that holds it.
double reach(const Solid& solid);
/// Of a homogeneous ball, capsule or box about its middle, in its own axes, kg·m².
Eigen::Matrix3d inertia_of(const Solid& solid, double mass);
/// Of a homogeneous convex solid: its middle of mass (m), and its inertia about that (kg·m²), from the flux
/// through its surface.
Eigen::Matrix3d inertia_of(const ConvexHull& hull, double mass, Eigen::Vector3d& middle);

}  // namespace sinew::audit
