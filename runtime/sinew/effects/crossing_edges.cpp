#include "sinew/effects/crossing_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/effects/polyhedron.h"
#include "sinew/effects/separating_axes.h"

namespace sinew {
namespace {

constexpr double kFlat = 0.1;    ///< sine: how far from a face's normal both edges of the face support
constexpr double kAsGood = 0.1;  ///< of the thinnest half extent: a direction parts no worse than the best

/// The edges with a direction that support a solid towards `outwards`. Returns how many.
template <class T>
int supporting(const PlacedShape<T>& s, int direction, const Vec3<T>& outwards, std::array<Edge<T>, 4>& out) {
  if (s.shape != Shape::kBox) {
    out[0] = edge_of(s, kAxisNumber);
    return 1;
  }
  const int one = (direction + 1) % 3, two = (direction + 2) % 3;
  const T along_one = outwards.dot(s.rotation.col(one)), along_two = outwards.dot(s.rotation.col(two));
  int count = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const T x = corner & 1 ? T(1) : T(-1), y = corner & 2 ? T(1) : T(-1);
    if (x * along_one < T(-kFlat) || y * along_two < T(-kFlat)) continue;
    out[count++] = edge_of(s, 4 * direction + corner);
  }
  return count;
}

/// Where along an edge its ends begin, of 1: a box's corners stand for them.
template <class T>
T inner_part(const PlacedShape<T>& s, const Edge<T>& e) {
  if (!is_polyhedron(s.shape)) return T(1);
  return T(1) - T(box_rounding(s.size.template cast<double>(), double(s.unit))) / e.half_axis.norm();
}

}  // namespace

template <class T>
SignedDistance<T> separation(const PlacedShape<T>& a, const PlacedShape<T>& b) {
  if (a.hull || b.hull) {
    const SignedDistance<double> d =
        separation_of_hulls(Polyhedron(a.template cast<double>()), Polyhedron(b.template cast<double>()));
    return {T(d.distance), d.normal.template cast<T>(), T(0), Vec3<T>::Zero()};
  }
  const SeparatingAxes<T> axes(a, b);
  return {axes.distance, axes.normal, T(0), Vec3<T>::Zero()};
}

/// The same for solids one of which is convex.
template <class T>
void CrossingEdges<T>::find_of_hulls(const PlacedShape<T>& a, const PlacedShape<T>& b) {
  const Polyhedron of_a(a.template cast<double>()), of_b(b.template cast<double>());
  apart = T(separation_of_hulls(of_a, of_b).distance);
  const double radii = of_a.radius() + of_b.radius();
  const double least = std::min(double(apart), 0.0) - kAsGood * std::min(of_a.thinnest(), of_b.thinnest());
  const auto edge = [](const Polyhedron& s, const ConvexHull::Edge& e) {
    const int number = s.radius() > 0 ? kAxisNumber : static_cast<int>(&e - s.edges().data());
    return Edge<T>{s.center(e).template cast<T>(), s.half_axis(e).template cast<T>(), number};
  };
  for (const ConvexHull::Edge& of_first : of_a.edges())
    for (const ConvexHull::Edge& of_second : of_b.edges()) {
      const Vec3<double> along_a = of_a.half_axis(of_first), along_b = of_b.half_axis(of_second),
                         apart_by = of_b.center(of_second) - of_a.center(of_first);
      if (are_parallel<double>(along_a, along_b)) continue;
      Vec3<double> normal = along_a.cross(along_b).normalized();
      const bool turned = normal.dot(of_b.outwards(of_second) - of_a.outwards(of_first)) < 0;
      if (turned) normal = -normal;  // from b to a
      if (of_a.beyond_support(of_first, -normal) > kFlat || of_b.beyond_support(of_second, normal) > kFlat)
        continue;
      const Edge<T> p = edge(of_a, of_first), q = edge(of_b, of_second);
      const std::array<double, 2> at = nearest_along<double>(along_a, along_b, apart_by);
      if (!(std::abs(at[0]) <= double(inner_part(a, p)) && std::abs(at[1]) <= double(inner_part(b, q))))
        continue;
      if (-of_a.support(-normal) - of_b.support(normal) - radii < least) continue;
      if (count == kMostEdgePairs) return;
      pairs[count++] = {p, q, turned ? T(-1) : T(1), T(radii)};
    }
}

template <class T>
void CrossingEdges<T>::find(const PlacedShape<T>& a, const PlacedShape<T>& b) {
  count = 0;
  if (a.hull || b.hull) return find_of_hulls(a, b);
  const SeparatingAxes<T> axes(a, b);
  const Vec3<T> between = a.center - b.center;
  apart = axes.distance;
  const T least =
      std::min(apart, T(0)) - T(kAsGood) * std::min(thinnest(a.shape, a.size), thinnest(b.shape, b.size));
  for (int i = axes.first_a; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (axes.by[3 * i + j] < least) continue;
      const T side = between.dot(axes.products[3 * i + j]) < T(0) ? T(-1) : T(1);
      const Vec3<T> normal = side * axes.products[3 * i + j];  // from b to a
      std::array<Edge<T>, 4> of_a, of_b;
      const int edges_a = supporting<T>(a, i, -normal, of_a), edges_b = supporting<T>(b, j, normal, of_b);
      for (int m = 0; m < edges_a; ++m)
        for (int n = 0; n < edges_b; ++n) {
          const Edge<T>&p = of_a[m], &q = of_b[n];
          const T inner_p = inner_part(a, p), inner_q = inner_part(b, q);
          const std::array<T, 2> at = nearest_along<T>(p.half_axis, q.half_axis, q.center - p.center);
          if (!(std::abs(at[0]) <= inner_p && std::abs(at[1]) <= inner_q)) continue;
          if (count == kMostEdgePairs) return;
          pairs[count++] = {p, q, side, a.shape == Shape::kBox ? T(0) : a.size.x()};
        }
    }
}

template SignedDistance<float> separation<float>(const PlacedShape<float>&, const PlacedShape<float>&);
template SignedDistance<double> separation<double>(const PlacedShape<double>&, const PlacedShape<double>&);
template struct CrossingEdges<float>;
template struct CrossingEdges<double>;

}  // namespace sinew
