#include "sinew/character/spare_acceleration.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kUnlimited = 1e6;  ///< rad/s²

/// N·m that the muscles of a joint have left, the least of its degrees of freedom.
template <class T>
double torque_left(const Character<T>& character, int joint) {
  const std::span<const T> load = character.load(), limit = character.limit();
  double left = kUnlimited;
  for (int k = 0; k < dof_count(character.skeleton().joints[std::size_t(joint)].type); ++k) {
    const std::size_t dof = std::size_t(character.first_dof(joint)) + std::size_t(k);
    const double most = double(limit[dof]);
    if (most > 0 && std::isfinite(most)) left = std::min(left, most * std::max(0.0, 1 - double(load[dof])));
  }
  return left;
}

}  // namespace

template <class T>
void carried_inertia(const Character<T>& character, std::span<T> out) {
  const Skeleton& skeleton = character.skeleton();
  const std::span<const Transform<T>> model = character.model();
  const int bodies = std::min(skeleton.body_count, static_cast<int>(out.size()));
  // Every body adds ½ tr I + m|c − o|² to all joints above it and its own.
  std::fill(out.begin(), out.end(), T(0));
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& body = skeleton.joints[std::size_t(i)];
    const Vec3<double> center = model[std::size_t(i)].template cast<double>() * body.center_of_mass;
    for (int j = i; j >= 0; j = skeleton.joints[std::size_t(j)].parent) {
      if (j >= bodies) continue;
      const Vec3<double> origin = model[std::size_t(j)].translation.template cast<double>();
      out[std::size_t(j)] += T(body.inertia.trace() / 2 + body.mass * (center - origin).squaredNorm());
    }
  }
}

template <class T>
void spare_acceleration(const Character<T>& character, std::span<T> out) {
  const Skeleton& skeleton = character.skeleton();
  carried_inertia<T>(character, out);
  for (std::size_t j = 0; j < out.size(); ++j) {
    const int joint = static_cast<int>(j);
    const bool moved = joint < skeleton.body_count && skeleton.joints[j].type != JointType::kFree;
    const double left = moved ? torque_left(character, joint) : kUnlimited, inertia = double(out[j]);
    out[j] = T(left < kUnlimited && inertia > 0 ? std::min(kUnlimited, left / inertia) : kUnlimited);
  }
}

template void carried_inertia<float>(const Character<float>&, std::span<float>);
template void carried_inertia<double>(const Character<double>&, std::span<double>);
template void spare_acceleration<float>(const Character<float>&, std::span<float>);
template void spare_acceleration<double>(const Character<double>&, std::span<double>);

}  // namespace sinew
