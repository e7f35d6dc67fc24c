// Where edges of two convex solids may cross: what signed distances of points do not see, as when a plank
// lies across another, or a staff over the edge of a table.
#pragma once

#include <array>

#include "sinew/effects/contact.h"

namespace sinew {

/// A capsule or box where it stands, about the common origin.
template <class T>
struct PlacedShape {
  Shape shape = Shape::kBox;
  Vec3<T> size = Vec3<T>::Zero();  ///< as Collider::size
  Vec3<T> center = Vec3<T>::Zero();
  Mat3<T> rotation = Mat3<T>::Identity();
  T unit = T(1);  ///< see box_rounding()

  PlacedShape(Shape of, const Vec3<T>& measures, const Transform<T>& pose, T length_unit)
      : shape(of),
        size(measures),
        center(pose.translation),
        rotation(pose.rotation.toRotationMatrix()),
        unit(length_unit) {}
};

/// An edge of a box, or the axis of a capsule.
template <class T>
struct Edge {
  Vec3<T> center = Vec3<T>::Zero(), half_axis = Vec3<T>::Zero();  ///< about the common origin
  int number = 0;  ///< of a box: 4 · direction + 1, 2 for its sides; of a capsule kAxisNumber
};
constexpr int kAxisNumber = 12;

/// Two edges that may touch within the step.
template <class T>
struct EdgePair {
  Edge<T> a, b;
  T side = T(1);    ///< the normal, from b to a, is side · half axis of a × that of b
  T radius = T(0);  ///< m, of a capsule
};

/// As many as one direction of each solid has: where a face lies on another two edges of either cross.
constexpr int kMostEdgePairs = 36;

/// The pairs of supporting edges of two solids, `b` a box, that cross within both, now or after a motion of a
/// against b (m), and part the solids no worse than what parts them best: along other directions edges may
/// cross that never touch (Gottschalk, Lin and Manocha, "OBBTree", 1996: the axes that separate boxes).
/// Returns how many were written. About 300 flops where the solids are near each other, one capsule 100.
template <class T>
int crossing_edges(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& motion,
                   std::array<EdgePair<T>, kMostEdgePairs>& out);

extern template int crossing_edges<float>(const PlacedShape<float>&, const PlacedShape<float>&,
                                          const Vec3<float>&, std::array<EdgePair<float>, kMostEdgePairs>&);
extern template int crossing_edges<double>(const PlacedShape<double>&, const PlacedShape<double>&,
                                           const Vec3<double>&,
                                           std::array<EdgePair<double>, kMostEdgePairs>&);

}  // namespace sinew
