#include "sinew/behaviour/pose_distance.h"

#include <cmath>

#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kArm =
    0.2;  ///< m of a human, by which a body's points are off its centre of mass: turned over costs 0.3

}  // namespace

template <class T>
void PosePoints<T>::prepare(const Skeleton& skeleton, double unit) {
  const double total = skeleton.total_mass();
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const Joint& joint = skeleton.joints[i];
    if (!(joint.mass > 0)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      joint_.push_back(static_cast<int>(i));
      at_.emplace_back(joint.center_of_mass + kArm * unit * Vec3<double>::Unit(axis));
      mass_.push_back(joint.mass / total / 3);
    }
  }
}

template <class T>
void PosePoints<T>::place(std::span<const Transform<T>> model, std::span<Vec3<double>> out) const {
  for (std::size_t n = 0; n < at_.size(); ++n) {
    const Transform<T>& joint = model[static_cast<std::size_t>(joint_[n])];
    out[n] = (joint * Vec3<T>(at_[n].template cast<T>())).template cast<double>();
  }
}

Fit fit_pose(std::span<const double> mass, std::span<const Vec3<double>> pose,
             std::span<const Vec3<double>> is) {
  Vec3<double> from = Vec3<double>::Zero(), to = from;
  for (std::size_t n = 0; n < mass.size(); ++n) {
    from += mass[n] * pose[n];
    to += mass[n] * is[n];
  }
  double along = 0, across = 0;
  for (std::size_t n = 0; n < mass.size(); ++n) {
    const Vec3<double> a = pose[n] - from, b = is[n] - to;
    along += mass[n] * (a.x() * b.x() + a.y() * b.y());
    across += mass[n] * (a.x() * b.y() - a.y() * b.x());
  }
  Fit fit;
  fit.place.yaw = along == 0 && across == 0 ? 0 : portable::atan2(across, along);
  const Quat<double> turn = fit.place.turn();
  const Vec3<double> moved = to - turn * from;
  fit.place.x = moved.x();
  fit.place.y = moved.y();
  double square = 0;
  for (std::size_t n = 0; n < mass.size(); ++n)
    square += mass[n] * (is[n] - turn * pose[n] - Vec3<double>(moved.x(), moved.y(), 0)).squaredNorm();
  fit.off = std::sqrt(square);
  return fit;
}

template class PosePoints<float>;
template class PosePoints<double>;

}  // namespace sinew
