#include "sinew/effects/solid_gap.h"

#include <algorithm>
#include <cmath>

#include "sinew/effects/polyhedron.h"
#include "sinew/effects/separating_axes.h"

namespace sinew {
namespace {

/// What of a solid reaches furthest in a direction, of a capsule's core: a corner, an edge or a face.
template <class T>
struct Furthest {
  Vec3<T> center;
  T extent = T(0);  ///< m², half axes of what lies level
};
template <class T>
Furthest<T> furthest(const PlacedShape<T>& s, const Vec3<T>& direction) {
  Furthest<T> at{s.center};
  for (int i = s.shape == Shape::kBox ? 0 : 2; i < 3; ++i) {
    const T side = std::clamp(direction.dot(s.rotation.col(i)) / T(kLevel), T(-1), T(1));
    at.center += side * s.size[i] * s.rotation.col(i);
    const T level = (T(1) - std::abs(side)) * s.size[i];
    at.extent += level * level;
  }
  return at;
}

/// The edge with a direction that reaches furthest.
template <class T>
Edge<T> furthest_edge(const PlacedShape<T>& s, int direction, const Vec3<T>& outwards) {
  if (s.shape != Shape::kBox) return edge_of(s, kAxisNumber);
  const int one = (direction + 1) % 3, two = (direction + 2) % 3;
  return edge_of(s, 4 * direction + (s.rotation.col(one).dot(outwards) > T(0) ? 1 : 0) +
                        (s.rotation.col(two).dot(outwards) > T(0) ? 2 : 0));
}

/// Of a box or capsule from a box, by the best of the axes that separate them.
template <class T>
SolidGap<T> gap_of_boxes(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& before) {
  const SeparatingAxes<T> axes(a, b, before);
  SolidGap<T> gap{axes.distance, axes.normal, Vec3<T>::Zero()};
  if (axes.of_a < 0) {  // where faces of both lie level, nearer to the smaller one's middle
    const Furthest<T> of_a = furthest<T>(a, -gap.normal), of_b = furthest<T>(b, gap.normal);
    const T both = of_a.extent + of_b.extent, share = both > T(0) ? of_a.extent / both : T(0.5);
    gap.point = of_a.center + share * (of_b.center - of_a.center);
  } else {
    const Edge<T> p = furthest_edge<T>(a, axes.of_a, -gap.normal),
                  q = furthest_edge<T>(b, axes.of_b, gap.normal);
    const T along = nearest_along<T>(p.half_axis, q.half_axis, q.center - p.center)[0];
    gap.point = p.center + std::clamp(along, T(-1), T(1)) * p.half_axis;
  }
  return gap;
}

/// How far along a capsule's axis c + t·h, t in [−1, 1], it is nearest to a box about the origin: the zero of
/// half the squared distance's derivative, which is piecewise linear and grows. Where it lies level with a
/// face in its middle, and not at the end that rounding chooses.
template <class T>
T nearest_to_box(const Vec3<T>& c, const Vec3<T>& h, T radius, const Vec3<T>& size) {
  const T level = T(kLevel) * radius * h.norm();
  const auto slope = [&](T t) {
    const Vec3<T> at = c + t * h;
    return h.dot(Vec3<T>(at - at.cwiseMax(-size).cwiseMin(size))) + level * t;
  };
  T low = T(-1), high = T(1), at_low = slope(low), at_high = slope(high);
  if (!(at_low < T(0))) return at_high > T(0) || at_low > T(0) ? low : T(0);
  if (!(at_high > T(0))) return at_high < T(0) ? high : T(0);
  for (int i = 0; i < 3; ++i) {
    for (const T face : {-size[i], size[i]}) {  // the slope has its kinks where the axis crosses these planes
      const T t = (face - c[i]) / h[i];
      if (!(t > low && t < high)) continue;
      const T here = slope(t);
      (here < T(0) ? low : high) = t;
      (here < T(0) ? at_low : at_high) = here;
    }
  }
  return low - at_low * (high - low) / (at_high - at_low);
}

/// A capsule and a box.
template <class T>
SolidGap<T> of_capsule(const PlacedShape<T>& capsule, const PlacedShape<T>& box, const Vec3<T>& before) {
  const Mat3<T> to_box = box.rotation.transpose();
  const Vec3<T> center = to_box * (capsule.center - box.center),
                half = capsule.size.z() * (to_box * capsule.rotation.col(2));
  const Vec3<T> at = center + nearest_to_box<T>(center, half, capsule.size.x(), box.size) * half;
  const Vec3<T> off = at - at.cwiseMax(-box.size).cwiseMin(box.size);
  const T distance = off.norm();
  if (distance > T(1e-3) * capsule.size.x()) {
    const Vec3<T> normal = box.rotation * (off / distance);
    if (normal.dot(before) > T(kBack))
      return {distance - capsule.size.x(), normal, box.center + box.rotation * at};
  }
  return gap_of_boxes<T>(capsule, box, before);
}

}  // namespace

template <class T>
SolidGap<T> solid_gap(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& before) {
  if (a.hull || b.hull) {
    const SolidGap<double> gap =
        gap_of_hulls(a.template cast<double>(), b.template cast<double>(), before.template cast<double>());
    return {T(gap.distance), gap.normal.template cast<T>(), gap.point.template cast<T>()};
  }
  if (a.shape != Shape::kBox) return of_capsule<T>(a, b, before);
  if (b.shape == Shape::kBox) return gap_of_boxes<T>(a, b, before);
  SolidGap<T> gap = of_capsule<T>(b, a, -before);
  gap.normal = -gap.normal;
  return gap;
}

template SolidGap<float> solid_gap<float>(const PlacedShape<float>&, const PlacedShape<float>&,
                                          const Vec3<float>&);
template SolidGap<double> solid_gap<double>(const PlacedShape<double>&, const PlacedShape<double>&,
                                            const Vec3<double>&);

}  // namespace sinew
