// Balls that overlap, found in a grid over the ground plane: O(n) where they are spread out.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sinew/skeleton/transform.h"

namespace sinew {

/// Rebuilt every step; results come in the order of the balls, whatever their places hash to.
class NeighbourGrid {
 public:
  /// Set-up for so many balls; nothing allocates afterwards.
  void reserve(int balls);
  void clear() { balls_.clear(); }
  /// A ball about `center` (m). `id` is what overlapping() answers with; add in ascending order. Returns how
  /// many were added before.
  int add(int id, const Vec3<double>& center, double radius);
  /// Sorts what was added into cells.
  void build();

  /// The same for one of the balls themselves, by its number; itself included.
  template <class Visit>
  void overlapping(int ball, Visit&& visit) const {
    const Ball& b = balls_[std::size_t(ball)];
    overlapping(b.center, b.radius, visit);
  }
  /// Calls visit(id) for every ball that overlaps the given one. Few cells are looked at, unless the radius
  /// is beyond kLarge.
  template <class Visit>
  void overlapping(const Vec3<double>& center, double radius, Visit&& visit) const {
    const auto try_ball = [&](const Ball& b) {
      const double reach = radius + b.radius;
      if ((b.center - center).squaredNorm() < reach * reach) visit(b.id);
    };
    for (const int n : large_) try_ball(balls_[n]);
    const double reach = radius + cell_ / 2;
    if (radius > kLarge) {
      for (const Ball& b : balls_)
        if (!(b.radius > kLarge)) try_ball(b);
      return;
    }
    const int x_end = cell_of(center.x() + reach), y_end = cell_of(center.y() + reach);
    for (int x = cell_of(center.x() - reach); x <= x_end; ++x)
      for (int y = cell_of(center.y() - reach); y <= y_end; ++y) {
        const std::uint32_t bucket = bucket_of(x, y);
        for (int k = first_[bucket]; k < first_[bucket + 1]; ++k) {
          const Ball& b = balls_[order_[k]];
          if (b.x == x && b.y == y) try_ball(b);  // others hash to the same bucket
        }
      }
  }

 private:
  static constexpr double kLarge = 3;  ///< m; larger ones are few and compared with everything

  struct Ball {
    Vec3<double> center = Vec3<double>::Zero();
    double radius = 0;
    int id = 0, x = 0, y = 0;  ///< cell
  };

  int cell_of(double at) const {
    constexpr double far = 1e9;  // beyond, everything shares the outermost cells
    const double cell = std::floor(at / cell_);
    return cell > far ? int(far) : cell > -far ? int(cell) : int(-far);
  }
  std::uint32_t bucket_of(int x, int y) const {
    const std::uint64_t mixed =
        (std::uint64_t(std::uint32_t(x)) << 32 | std::uint32_t(y)) * 0x9e3779b97f4a7c15ull;
    return static_cast<std::uint32_t>(mixed >> 40) & mask_;
  }

  std::vector<Ball> balls_;
  std::vector<int> large_;          ///< into balls_
  std::vector<int> first_, order_;  ///< [bucket + 1] into order_; balls by bucket
  std::uint32_t mask_ = 0;          ///< buckets − 1
  double cell_ = 1;                 ///< m
};

}  // namespace sinew
