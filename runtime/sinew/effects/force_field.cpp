#include "sinew/effects/force_field.h"

#include <cmath>

namespace sinew {

template <class T>
Status ForceField<T>::attach(const Skeleton& skeleton, const Tree<T>& /*tree*/) {
  if (!settings.center.allFinite() || !std::isfinite(settings.acceleration) || !(settings.reach > 0))
    return Status::error(Code::kInvalidArgument,
                         "force field needs a finite centre and acceleration, and a reach > 0");
  return bodies_named(skeleton, settings.joints, bodies_);
}

template <class T>
typename ForceField<T>::Place ForceField<T>::place(const EffectPose<T>& pose, int body) const {
  const Vec3<T> center = (settings.center - pose.common_origin).template cast<T>();
  const Vec3<T> offset = (pose.kinematics.center[body] - center) / T(settings.reach);
  return {offset, std::sqrt(1 + offset.squaredNorm())};
}

template <class T>
double ForceField<T>::add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const {
  double energy = 0;
  for (const int body : bodies_) {
    const Place at = place(pose, body);
    const T pull = pose.tree.mass[body] * T(settings.acceleration);
    energy += double(pull * T(settings.reach) * (at.root - 1));
    out.add(body, pose.kinematics.center[body], (pull / at.root) * at.offset);
  }
  return energy;
}

template <class T>
void ForceField<T>::add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const {
  for (const int body : bodies_) {
    const Place at = place(pose, body);
    const T pull = pose.tree.mass[body] * T(settings.acceleration);
    Mat3<T> change = Mat3<T>::Zero();
    if (pull > T(0))
      change = (pull / (T(settings.reach) * at.root)) *
               (Mat3<T>::Identity() - at.offset * at.offset.transpose() / (at.root * at.root));
    out.add(body, pose.kinematics.center[body], (pull / at.root) * at.offset, change);
  }
}

template <class T>
void ForceField<T>::add_load(const EffectPose<T>& pose, const Motion<T>& /*motion*/,
                             const Wrenches<T>& out) const {
  add_gradient(pose, out);
}

template class ForceField<float>;
template class ForceField<double>;

}  // namespace sinew
