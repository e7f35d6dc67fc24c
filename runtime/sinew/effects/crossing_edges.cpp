#include "sinew/effects/crossing_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kParallel = 0.05;  ///< sine: edges nearer to it touch by their ends
constexpr double kFlat = 0.1;       ///< sine: how far from a face's normal both edges of the face support
constexpr double kAsGood = 0.1;     ///< of the thinnest half extent: a direction parts no worse than the best

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
    out[0] = {s.center, s.rotation.col(2) * s.size.z(), kAxisNumber};
    return 1;
  }
  const int one = (direction + 1) % 3, two = (direction + 2) % 3;
  const T along_one = outwards.dot(s.rotation.col(one)), along_two = outwards.dot(s.rotation.col(two));
  int count = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const T x = corner & 1 ? T(1) : T(-1), y = corner & 2 ? T(1) : T(-1);
    if (x * along_one < T(-kFlat) || y * along_two < T(-kFlat)) continue;
    out[count++] = {s.center + x * s.size[one] * s.rotation.col(one) + y * s.size[two] * s.rotation.col(two),
                    s.rotation.col(direction) * s.size[direction], 4 * direction + corner};
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
int crossing_edges(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& motion,
                   std::array<EdgePair<T>, kMostEdgePairs>& out) {
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
      const T sine = normal.norm();
      by[3 * i + j] = -std::numeric_limits<T>::infinity();
      if (sine < T(kParallel)) continue;
      normal /= sine;
      by[3 * i + j] = parted(normal);
      best = std::max(best, by[3 * i + j]);
    }
  const T least = std::min(best, T(0)) - T(kAsGood) * std::min(thinnest(a), thinnest(b));
  int count = 0;
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
          const auto cross_within = [&](const Vec3<T>& r) {
            const std::array<T, 2> at = nearest_along(p.half_axis, q.half_axis, r);
            return std::abs(at[0]) <= inner_p && std::abs(at[1]) <= inner_q;
          };
          const Vec3<T> apart = q.center - p.center;
          if (!cross_within(apart) && !cross_within(apart - motion)) continue;
          if (count == kMostEdgePairs) return count;
          out[count++] = {p, q, side, a.shape == Shape::kBox ? T(0) : a.size.x()};
        }
    }
  return count;
}

template int crossing_edges<float>(const PlacedShape<float>&, const PlacedShape<float>&, const Vec3<float>&,
                                   std::array<EdgePair<float>, kMostEdgePairs>&);
template int crossing_edges<double>(const PlacedShape<double>&, const PlacedShape<double>&,
                                    const Vec3<double>&, std::array<EdgePair<double>, kMostEdgePairs>&);

}  // namespace sinew
