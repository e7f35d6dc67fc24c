#include "study/behaviour/slip.h"

#include <algorithm>
#include <vector>

namespace sinew::study {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTouches = 1e-3;  ///< m over the ground

/// Points on which a solid may stand, m, world.
std::vector<Vector3d> lowest_points(const audit::Solid& solid) {
  std::vector<Vector3d> points;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        points.emplace_back(solid.pose *
                                Vector3d(x * solid.half.x(), y * solid.half.y(), z * solid.half.z()) -
                            solid.radius * Vector3d::UnitZ());
  return points;
}

}  // namespace

void Slip::look(const audit::Solid& before, const audit::Solid& now, double ground) {
  const Eigen::Isometry3d moved = now.pose * before.pose.inverse();
  for (const Vector3d& point : lowest_points(before)) {
    const Vector3d to = moved * point;
    if (point.z() > ground + kTouches || to.z() > ground + kTouches) continue;
    const Vector2d way = (to - point).head<2>();
    if (!least_ || way.norm() < least_->norm()) least_ = way;
  }
}

void Slip::end_frame() {
  sum_ = least_ ? Vector2d(sum_ + *least_) : Vector2d::Zero();
  furthest_ = std::max(furthest_, sum_.norm());
  least_.reset();
}

}  // namespace sinew::study
