// Where feet that stand can press: the hull of their soles, seen from above. Internal to behaviours.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sinew/skeleton/scalar.h"

namespace sinew {

/// Seen from above: X and Y.
using Vec2 = Eigen::Vector2d;

/// Without its height.
inline Vec2 from_above(const Vec3<double>& v) {
  return v.head<2>();
}

/// A convex polygon on the ground, m. Counterclockwise once closed.
class Sole {
 public:
  static constexpr std::size_t kMostCorners = 32;  ///< before it is closed

  /// Points beyond kMostCorners are left out.
  void add(const Vec2& corner) {
    if (count_ < kMostCorners) corners_[count_++] = corner;
  }
  /// Makes the hull of what was added: before anything else is asked. O(n log n).
  void close();
  bool empty() const { return count_ == 0; }                                   ///< nothing was added
  std::span<const Vec2> corners() const { return {corners_.data(), count_}; }  ///< m
  Vec2 middle() const;  ///< m, mean of the corners; 0 where there is none
  /// The nearest point that lies `margin` (m) inside all edges, or the middle where none does.
  Vec2 nearest(const Vec2& point, double margin) const;
  /// How far a point is inside, negative outside, m: from the nearest edge's line. Of fewer than three
  /// corners always outside, by the way to the middle.
  double depth(const Vec2& point) const;

 private:
  std::array<Vec2, kMostCorners> corners_;
  std::size_t count_ = 0;
};

}  // namespace sinew
