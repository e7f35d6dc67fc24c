#include "sinew/effects/crossing_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kFlat = 0.1;    ///< sine: how far from a face's normal both edges of the face support
constexpr double kAsGood = 0.1;  ///< of the thinnest half extent: a direction parts no worse than the best

template <class T>
T thinnest(const PlacedShape<T>& s) {
  return s.shape == Shape::kBox ? s.size.minCoeff() : s.size.x();
}

/// Half of what a solid extends along a unit direction, m.
template <class T>
T extent(const PlacedShape<T>& s, const Vec3<T>& direction) {
  const Vec3<T> in_shape = s.rotation.transpose() * direction;
  if (s.shape == Shape::kBox) return in_shape.cwiseAbs().dot(s.size);
  return std::abs(in_shape.z()) * s.size.z() + s.size.x();
}

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
  if (s.shape != Shape::kBox) return T(1);
  return T(1) - T(box_rounding(s.size.template cast<double>(), double(s.unit))) / e.half_axis.norm();
}

}  // namespace

template <class T>
void CrossingEdges<T>::find(const PlacedShape<T>& a, const PlacedShape<T>& b) {
  count = 0;
  const Vec3<T> between = a.center - b.center;
  const auto parted = [&](const Vec3<T>& direction) {
    return std::abs(between.dot(direction)) - extent(a, direction) - extent(b, direction);
  };
  const int first_a = a.shape == Shape::kBox ? 0 : 2;
  T best = -std::numeric_limits<T>::infinity();
  for (int i = 0; i < 3; ++i) {
    best = std::max(best, parted(b.rotation.col(i)));
    if (a.shape == Shape::kBox) best = std::max(best, parted(a.rotation.col(i)));
  }
  std::array<T, 9> by{};
  std::array<Vec3<T>, 9> normals;
  for (int i = first_a; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Vec3<T>& normal = normals[3 * i + j];
      normal = a.rotation.col(i).cross(b.rotation.col(j));
      by[3 * i + j] = -std::numeric_limits<T>::infinity();
      if (are_parallel<T>(a.rotation.col(i), b.rotation.col(j))) continue;
      normal.normalize();
      by[3 * i + j] = parted(normal);
      best = std::max(best, by[3 * i + j]);
    }
  const T least = std::min(best, T(0)) - T(kAsGood) * std::min(thinnest(a), thinnest(b));
  apart = best;
  for (int i = first_a; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (by[3 * i + j] < least) continue;
      const T side = between.dot(normals[3 * i + j]) < T(0) ? T(-1) : T(1);
      const Vec3<T> normal = side * normals[3 * i + j];  // from b to a
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

template struct CrossingEdges<float>;
template struct CrossingEdges<double>;

}  // namespace sinew
