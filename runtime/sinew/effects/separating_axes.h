// The axes that may separate a box from another or from a capsule.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "sinew/effects/crossing_edges.h"
#include "sinew/effects/solid_gap.h"

namespace sinew {

constexpr double kFaceFirst = 1e-3;  ///< of both extents: so much better edges must be than faces

/// m, half of what a box or a capsule extends along a unit direction.
template <class T>
T extent(const PlacedShape<T>& s, const Vec3<T>& direction) {
  const Vec3<T> in_shape = (s.rotation.transpose() * direction).cwiseAbs();
  return s.shape == Shape::kBox ? in_shape.dot(s.size) : in_shape.z() * s.size.z() + s.size.x();
}

/// What parts a box or capsule `a` from a box `b`, along every axis and along the best: normals of faces and
/// products of edges, of a capsule its axis (Gottschalk, Lin and Manocha, "OBBTree", 1996). 200 flops.
template <class T>
struct SeparatingAxes {
  T distance = -std::numeric_limits<T>::infinity();  ///< m; negative: how deep they are in each other
  Vec3<T> normal = Vec3<T>::UnitZ();                 ///< from b to a
  int of_a = -1, of_b = -1;         ///< directions of the edges that are square to it; −1, −1: a face's
  std::array<Vec3<T>, 9> products;  ///< [3 · edge of a + edge of b], unit, of either sign
  std::array<T, 9> by{};            ///< m, along them; −∞ where the two are parallel
  int first_a = 0;                  ///< direction of a's edges: its first

  /// `before`: see solid_gap(); zero: whatever parts them.
  SeparatingAxes(const PlacedShape<T>& a, const PlacedShape<T>& b, const Vec3<T>& before = Vec3<T>::Zero())
      : first_a(a.shape == Shape::kBox ? 0 : 2) {
    const Vec3<T> between = a.center - b.center;
    const auto look_along = [&](const Vec3<T>& axis, int edge_a, int edge_b) {
      const T along = axis.dot(between), back = axis.dot(before), reach = extent(a, axis) + extent(b, axis);
      const bool forth = along >= T(0) ? back > T(kBack) : -back > T(kBack);
      const T side = (along >= T(0)) == forth ? T(1) : T(-1), apart = side * along - reach;
      // Two edges that lie in a face part no better than that.
      if (apart > distance + (edge_a < 0 ? T(0) : T(kFaceFirst) * reach)) {
        distance = apart;
        normal = side * axis;
        of_a = edge_a;
        of_b = edge_b;
      }
      return apart;
    };
    for (int i = 0; i < 3; ++i) {
      look_along(b.rotation.col(i), -1, -1);
      if (a.shape == Shape::kBox) look_along(a.rotation.col(i), -1, -1);
    }
    by.fill(-std::numeric_limits<T>::infinity());
    for (int i = first_a; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        if (are_parallel<T>(a.rotation.col(i), b.rotation.col(j))) continue;
        Vec3<T>& product = products[3 * i + j];
        product = a.rotation.col(i).cross(b.rotation.col(j)).normalized();
        by[3 * i + j] = look_along(product, i, j);
      }
  }
};

}  // namespace sinew
