// Points against the hull of a convex solid.
#pragma once

#include <vector>

#include "sinew/effects/contact.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {

/// Of a point in the hull's axes: exact, inside to the nearest face. O(faces + edges): 0.3 µs outside of
/// twenty faces.
SignedDistance<double> hull_distance(const ConvexHull& hull, const Vec3<double>& point);

/// A small ball in a corner of a hull, which touches its faces from within.
struct RoundedCorner {
  Vec3<double> center = Vec3<double>::Zero();  ///< m, in the hull's axes
  double radius = 0;                           ///< m
};

/// One for each corner, its middle `rounding` (m) from it. For set-up: it takes memory from the heap.
std::vector<RoundedCorner> rounded_corners(const ConvexHull& hull, double rounding);

}  // namespace sinew
