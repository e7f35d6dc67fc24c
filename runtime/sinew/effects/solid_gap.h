// How far two solids are from each other as wholes, whichever of their features are nearest: what contacts of
// single points and edges, chosen when a step begins, may miss.
#pragma once

#include "sinew/effects/crossing_edges.h"

namespace sinew {

constexpr double kBack = -0.5;   ///< cosine to where they were apart: beyond, a direction leads back through
constexpr double kLevel = 0.02;  ///< sine: a face or an edge that lies less level is touched at its end

template <class T>
struct SolidGap {
  T distance = T(0);  ///< m; negative: how far the first has to move along the normal to leave the second
  Vec3<T> normal = Vec3<T>::UnitZ();  ///< from the second to the first
  Vec3<T> point = Vec3<T>::Zero();    ///< where they are nearest, or deepest; about the common origin
};

/// Of boxes, capsules and convex solids, one of them no capsule. Where they overlap, the way out of the other
/// by the shortest of the directions that do not lead back through it: `before`, where they were apart when
/// the step began, as `normal`; zero: any. Boxes that are apart: by the best of the axes that separate them,
/// no more than their distance. 300 flops for boxes that are near each other, 100 for a capsule; of convex
/// solids see gap_of_hulls().
template <class T>
SolidGap<T> solid_gap(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& before);

extern template SolidGap<float> solid_gap<float>(const PlacedShape<float>&, const PlacedShape<float>&,
                                                 const Vec3<float>&);
extern template SolidGap<double> solid_gap<double>(const PlacedShape<double>&, const PlacedShape<double>&,
                                                   const Vec3<double>&);

}  // namespace sinew
