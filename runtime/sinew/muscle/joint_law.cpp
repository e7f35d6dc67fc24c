#include "sinew/muscle/joint_law.h"

#include <algorithm>

namespace sinew {

template <class T>
JointLaw<T>::JointLaw(const Tree<T>& tree, const Skeleton& skeleton) {
  for (int i = 0; i < tree.bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const DofLimits& dof = joint.dofs[k];
      torque_minus.push_back(T(dof.torque_minus));
      torque_plus.push_back(T(dof.torque_plus));
      dry_friction.push_back(joint.type == JointType::kFree ? T(0) : T(dof.dry_friction));
      damping.push_back(T(dof.damping));
      lower.push_back(T(dof.lower));
      upper.push_back(T(dof.upper));
    }
    swing_limit.push_back(joint.type == JointType::kBall ? T(joint.swing_limit) : T(-1));
    swing_axis.push_back(joint.swing_axis.cast<T>());
    twist_lower.push_back(T(joint.twist_lower));
    twist_upper.push_back(T(joint.twist_upper));
    ellipsoidal.push_back(joint.ellipsoidal_limit);
  }
  refresh_presence();
}

template <class T>
void JointLaw<T>::refresh_presence() {
  const auto above = [](const std::vector<T>& values, T least) {
    return std::any_of(values.begin(), values.end(), [&](T value) { return value > least; });
  };
  const auto below = [](T value) { return value < kUnlimited; };
  present.muscles = above(torque_minus, T(0)) || above(torque_plus, T(0));
  present.tone = std::any_of(tone.begin(), tone.end(), [](const ToneOfDof<T>& t) { return !t.rigid(); });
  present.losses = above(dry_friction, T(0)) || above(damping, T(0));
  present.ranges = above(lower, -kUnlimited) || std::any_of(upper.begin(), upper.end(), below);
  present.cones = std::any_of(swing_limit.begin(), swing_limit.end(), [](T most) { return most >= T(0); });
}

template <class T>
T JointLaw<T>::load(const Tree<T>& tree, int body, int dof, std::span<const T> torque) const {
  const auto share = [&](int n) {
    const T most = limit(n, torque[n]);
    return most > T(0) && std::isfinite(most) ? std::abs(torque[n]) / most : T(0);
  };
  if (!ellipsoidal[body]) return share(dof);
  const int first = tree.first_dof[body];
  return Vec3<T>(share(first), share(first + 1), share(first + 2)).norm();
}

template struct JointLaw<float>;
template struct JointLaw<double>;

}  // namespace sinew
