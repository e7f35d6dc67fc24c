// Where edges of two convex solids may cross: what signed distances of points do not see, as when a plank
// lies across another, or a staff over the edge of a table.
#pragma once

#include <array>

#include "sinew/effects/contact.h"

namespace sinew {

/// A capsule, box or convex solid where it stands, about the common origin.
template <class T>
struct PlacedShape {
  Shape shape = Shape::kBox;
  Vec3<T> size = Vec3<T>::Zero();  ///< as Collider::size
  Vec3<T> center = Vec3<T>::Zero();
  Mat3<T> rotation = Mat3<T>::Identity();
  T unit = T(1);                     ///< see box_rounding()
  const ConvexHull* hull = nullptr;  ///< of who is convex

  PlacedShape(Shape of, const Vec3<T>& measures, const Transform<T>& pose, T length_unit,
              const ConvexHull* of_hull = nullptr)
      : shape(of),
        size(measures),
        center(pose.translation),
        rotation(pose.rotation.toRotationMatrix()),
        unit(length_unit),
        hull(of_hull) {}
  /// The same in another precision.
  template <class U>
  PlacedShape<U> cast() const {
    return {shape, size.template cast<U>(), center.template cast<U>(), rotation.template cast<U>(), U(unit),
            hull};
  }

 private:
  template <class U>
  friend struct PlacedShape;
  PlacedShape(Shape of, const Vec3<T>& measures, const Vec3<T>& at, const Mat3<T>& turned, T length_unit,
              const ConvexHull* of_hull)
      : shape(of), size(measures), center(at), rotation(turned), unit(length_unit), hull(of_hull) {}
};

/// m: half of where a shape of that size (as Collider::size) is thinnest, or less.
template <class T>
T thinnest(Shape shape, const Vec3<T>& size) {
  return shape == Shape::kBox ? size.minCoeff() : size.x();
}

/// How far a solid is from another (m, negative: by how much they overlap), and the direction in which a
/// leaves b, by the best of the axes that separate boxes (Gottschalk, Lin and Manocha, "OBBTree", 1996):
/// where corners or a capsule's ends are nearest, they are further apart than that. About 200 flops; of
/// convex solids see gap_of_hulls().
template <class T>
SignedDistance<T> separation(const PlacedShape<T>& a, const PlacedShape<T>& b);

/// An edge of a box, or the axis of a capsule.
template <class T>
struct Edge {
  Vec3<T> center = Vec3<T>::Zero(), half_axis = Vec3<T>::Zero();  ///< about the common origin
  int number = 0;  ///< of a box: 4 · direction + 1, 2 for its sides; of a capsule kAxisNumber; where either
                   ///< solid is convex, that of Polyhedron::edges
};
constexpr int kAxisNumber = 12;

/// Two edges that may touch within the step.
template <class T>
struct EdgePair {
  Edge<T> a, b;
  T side = T(1);    ///< the normal, from b to a, is side · half axis of a × that of b
  T radius = T(0);  ///< m, of a capsule
};

/// The edge with such a number of a solid.
template <class T>
Edge<T> edge_of(const PlacedShape<T>& s, int number) {
  if (s.shape != Shape::kBox) return {s.center, s.rotation.col(2) * s.size.z(), kAxisNumber};
  const int along = number / 4, one = (along + 1) % 3, two = (along + 2) % 3;
  const T x = number & 1 ? T(1) : T(-1), y = number & 2 ? T(1) : T(-1);
  return {s.center + x * s.size[one] * s.rotation.col(one) + y * s.size[two] * s.rotation.col(two),
          s.rotation.col(along) * s.size[along], number};
}

/// Sine of the angle between two edges below which they touch by their ends.
constexpr double kParallelEdges = 0.05;
template <class T>
bool are_parallel(const Vec3<T>& a, const Vec3<T>& b) {
  return a.cross(b).squaredNorm() <= T(kParallelEdges * kParallelEdges) * a.squaredNorm() * b.squaredNorm();
}

/// As many as one direction of each solid has: where a face lies on another two edges of either cross.
constexpr int kMostEdgePairs = 36;

/// The pairs of supporting edges of two solids, `b` a polyhedron, that cross within both and part the solids
/// no worse than what parts them best, see separation(): along other directions edges may cross that never
/// touch. About 300 flops where the solids are near each other, one capsule 100.
template <class T>
struct CrossingEdges {
  std::array<EdgePair<T>, kMostEdgePairs> pairs;
  int count = 0;
  T apart = T(0);  ///< m, see separation()

  void find(const PlacedShape<T>& a, const PlacedShape<T>& b);

 private:
  void find_of_hulls(const PlacedShape<T>& a, const PlacedShape<T>& b);
};

extern template SignedDistance<float> separation<float>(const PlacedShape<float>&, const PlacedShape<float>&);
extern template SignedDistance<double> separation<double>(const PlacedShape<double>&,
                                                          const PlacedShape<double>&);
extern template struct CrossingEdges<float>;
extern template struct CrossingEdges<double>;

}  // namespace sinew
