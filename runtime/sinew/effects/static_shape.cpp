#include "sinew/effects/static_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

/// Weights of the four samples about a point at t in [0, 1] between the middle two, and their derivatives.
void catmull_rom(double t, std::array<double, 4>& weight, std::array<double, 4>& slope) {
  weight = {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)),
            t * t * (-0.5 + 0.5 * t)};
  slope = {-0.5 + t * (2 - 1.5 * t), t * (-5 + 4.5 * t), 0.5 + t * (4 - 4.5 * t), t * (-1 + 1.5 * t)};
}

/// Cell and position in it; beyond the grid the last cell's edge. A trial step of a solve may ask for NaN:
/// `t` is it then.
long cell(double grid, long count, double& t) {
  const double inside = std::clamp(grid, 0.0, double(count - 1));
  const long index = inside > 0 ? std::min(static_cast<long>(inside), std::max(count - 2, 0L)) : 0;
  t = inside - double(index);
  return index;
}

}  // namespace

HeightField::HeightField(std::span<const double> heights, std::size_t columns, const Vec3<double>& corner,
                         double spacing)
    : heights_(heights.begin(), heights.end()),
      columns_(static_cast<long>(columns)),
      rows_(static_cast<long>(heights.size() / std::max<std::size_t>(columns, 1))),
      corner_(corner),
      spacing_(spacing) {}

double HeightField::sample(long column, long row) const noexcept {
  const long c = std::clamp(column, 0L, columns_ - 1), r = std::clamp(row, 0L, rows_ - 1);
  return heights_[static_cast<std::size_t>(r * columns_ + c)];
}

double HeightField::height(double x, double y, double& by_x, double& by_y) const noexcept {
  const double gx = (x - corner_.x()) / spacing_, gy = (y - corner_.y()) / spacing_;
  double tx = 0, ty = 0;
  const long column = cell(gx, columns_, tx), row = cell(gy, rows_, ty);
  std::array<double, 4> wx{}, wy{}, sx{}, sy{};
  catmull_rom(tx, wx, sx);
  catmull_rom(ty, wy, sy);
  double z = 0;
  by_x = by_y = 0;
  for (std::size_t r = 0; r < 4; ++r) {
    double along = 0, slope = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const double h = sample(column + long(c) - 1, row + long(r) - 1);
      along += wx[c] * h;
      slope += sx[c] * h;
    }
    z += wy[r] * along;
    by_x += wy[r] * slope;
    by_y += sy[r] * along;
  }
  // Beyond the grid the border's height goes on, level.
  by_x = gx < 0 || gx > double(columns_ - 1) ? 0 : by_x / spacing_;
  by_y = gy < 0 || gy > double(rows_ - 1) ? 0 : by_y / spacing_;
  return corner_.z() + z;
}

SignedDistance<double> HeightField::distance(const Vec3<double>& point) const noexcept {
  double by_x = 0, by_y = 0;
  const double above = point.z() - height(point.x(), point.y(), by_x, by_y);
  const double stretch = std::sqrt(1 + by_x * by_x + by_y * by_y);
  SignedDistance<double> d;
  d.distance = above / stretch;
  d.normal = Vec3<double>(-by_x, -by_y, 1) / stretch;
  return d;
}

ConvexSolid::ConvexSolid(std::span<const Face> faces, double inner_radius)
    : faces_(faces.begin(), faces.end()), inner_radius_(inner_radius) {}

SignedDistance<double> ConvexSolid::distance(const Vec3<double>& point) const noexcept {
  SignedDistance<double> d;
  d.distance = -std::numeric_limits<double>::max();
  for (const Face& f : faces_)
    if (const double beyond = f.normal.dot(point) - f.offset; beyond > d.distance) {
      d.distance = beyond;
      d.normal = f.normal;
    }
  return d;
}

}  // namespace sinew
