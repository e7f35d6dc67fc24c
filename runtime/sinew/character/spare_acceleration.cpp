#include "sinew/character/spare_acceleration.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kUnlimited = 1e6;  ///< rad/s²

/// Largest inertia of what hangs on a joint, itself included, about its origin: ½ tr I + m|c − o|² of each.
double inertia_below(const Skeleton& skeleton, int joint, const auto& model) {
  const Vec3<double> origin = model[joint].translation.template cast<double>();
  double sum = 0;
  for (int i = joint; i < skeleton.body_count; ++i) {
    int above = i;
    while (above > joint) above = skeleton.joints[above].parent;
    if (above != joint) continue;
    const Joint& body = skeleton.joints[i];
    const Vec3<double> center = model[i].template cast<double>() * body.center_of_mass;
    sum += body.inertia.trace() / 2 + body.mass * (center - origin).squaredNorm();
  }
  return sum;
}

}  // namespace

template <class T>
void spare_acceleration(const Character<T>& character, std::span<T> out) {
  const Skeleton& skeleton = character.skeleton();
  const std::span<const T> load = character.load(), limit = character.limit();
  const std::span<const Transform<T>> model = character.model();
  for (std::size_t j = 0; j < out.size(); ++j) {
    const int joint = static_cast<int>(j);
    out[j] = T(kUnlimited);
    if (joint >= skeleton.body_count || skeleton.joints[j].type == JointType::kFree) continue;
    double left = kUnlimited;  // N·m
    for (int k = 0; k < dof_count(skeleton.joints[j].type); ++k) {
      const std::size_t dof = std::size_t(character.first_dof(joint)) + std::size_t(k);
      const double most = double(limit[dof]);
      if (most > 0 && std::isfinite(most)) left = std::min(left, most * std::max(0.0, 1 - double(load[dof])));
    }
    const double inertia = left < kUnlimited ? inertia_below(skeleton, joint, model) : 0;
    if (inertia > 0) out[j] = T(std::min(kUnlimited, left / inertia));
  }
}

template void spare_acceleration<float>(const Character<float>&, std::span<float>);
template void spare_acceleration<double>(const Character<double>&, std::span<double>);

}  // namespace sinew
