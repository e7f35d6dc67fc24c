// How far a body is from a pose that may stand anywhere and face anywhere. Internal to behaviours.
#pragma once

#include <span>
#include <vector>

#include "sinew/character/world.h"

namespace sinew {

/// Points that stand for a body's pose, three for each body with mass: where it is and how it is turned.
template <class T>
class PosePoints {
 public:
  /// Set-up. `unit`: the figure's size, of a human's.
  void prepare(const Skeleton& skeleton, double unit);
  std::size_t count() const { return mass_.size(); }  ///< of points
  /// Of a pose in model space (joint → world), m. `out` has count().
  void place(std::span<const Transform<T>> model, std::span<Vec3<double>> out) const;
  std::span<const double> mass() const { return mass_; }  ///< [point] share of the whole

 private:
  std::vector<int> joint_;        ///< [point]
  std::vector<Vec3<double>> at_;  ///< m, joint axes
  std::vector<double> mass_;
};

/// Where a pose has to be put to be nearest to a body.
struct Fit {
  Displacement place;  ///< of the pose
  double off = 0;      ///< m: root of the mean square distance that is left, by mass
};

/// The turn about the vertical and the level way that take `pose` nearest to `is`; heights stay. Closed form
/// (Kovar, Gleicher and Pighin, "Motion graphs", 2002): with x and x̂ about their means,
/// yaw = atan2(Σm(x̂ × x)_z, Σm x̂·x). O(points).
Fit fit_pose(std::span<const double> mass, std::span<const Vec3<double>> pose,
             std::span<const Vec3<double>> is);

extern template class PosePoints<float>;
extern template class PosePoints<double>;

}  // namespace sinew
