#include "sinew/effects/buoyancy.h"

#include <algorithm>

namespace sinew {
namespace {

/// Submerged share of a ball whose centre is s radii below the surface; its integral from −1; its derivative.
template <class T>
T share(T s) {
  s = std::clamp(s, T(-1), T(1));
  return (1 + s) * (1 + s) * (2 - s) / 4;
}
template <class T>
T share_integral(T s) {
  const T inside = std::clamp(s, T(-1), T(1));
  const T x = 1 + inside;
  return x * x * x * (3 - inside) / 16 + std::max(s - T(1), T(0));
}
template <class T>
T share_slope(T s) {
  return std::abs(s) < T(1) ? T(0.75) * (1 - s * s) : T(0);
}

}  // namespace

template <class T>
Status Buoyancy<T>::attach(const Skeleton& skeleton, const Tree<T>& /*tree*/) {
  if (!(settings.density >= 0) || !(settings.volume >= 0) || !settings.flow.allFinite() ||
      !std::isfinite(settings.level))
    return Status::error(Code::kInvalidArgument,
                         "water needs a finite level and flow, and a density and volume ≥ 0");
  if (Status status = flow_spots<T>(skeleton, settings.joints, spots_); !status) return status;
  in_step_.resize(spots_.size());
  return {};
}

template <class T>
typename Buoyancy<T>::Floating Buoyancy<T>::floating(const FlowSpot<T>& spot,
                                                     const EffectPose<T>& pose) const {
  const Mat3<T>& turned = pose.kinematics.rotation[spot.body];
  Floating f;
  f.level = T(settings.level - pose.common_origin.z());
  f.radius = spot.round + (turned.row(2) * spot.extent).cwiseAbs().sum();
  f.weight = T(settings.density * settings.volume) * pose.gravity.norm() * spot.volume;
  f.drag.start = pose.point(spot.body, spot.local);
  f.drag.flow = settings.flow.template cast<T>();
  f.drag.spread = turned * spot.spread * turned.transpose();
  f.drag.half_density = T(settings.density / 2) * share((f.level - f.drag.start.z()) / f.radius);
  return f;
}

template <class T>
void Buoyancy<T>::begin_step(const EffectPose<T>& start) {
  for (std::size_t n = 0; n < spots_.size(); ++n) in_step_[n] = floating(spots_[n], start);
}

template <class T>
double Buoyancy<T>::add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const {
  double energy = 0;
  for (std::size_t n = 0; n < spots_.size(); ++n) {
    const Floating& f = in_step_[n];
    const Vec3<T> x = pose.point(spots_[n].body, spots_[n].local);
    const Vec3<T> slip = f.drag.slip(x, pose.h);
    const T depth = (f.level - x.z()) / f.radius;
    energy += double(f.drag.potential(slip, pose.h) + f.weight * f.radius * share_integral(depth));
    Vec3<T> gradient = f.drag.gradient(slip);
    gradient.z() -= f.weight * share(depth);
    out.add(spots_[n].body, x, gradient);
  }
  return energy;
}

template <class T>
void Buoyancy<T>::add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const {
  for (std::size_t n = 0; n < spots_.size(); ++n) {
    const Floating& f = in_step_[n];
    const Vec3<T> x = pose.point(spots_[n].body, spots_[n].local);
    const Vec3<T> slip = f.drag.slip(x, pose.h);
    const T depth = (f.level - x.z()) / f.radius;
    Vec3<T> gradient = f.drag.gradient(slip);
    gradient.z() -= f.weight * share(depth);
    Mat3<T> change = f.drag.change(slip, pose.h);
    change(2, 2) += f.weight * share_slope(depth) / f.radius;
    out.add(spots_[n].body, x, gradient, change);
  }
}

template <class T>
void Buoyancy<T>::add_load(const EffectPose<T>& pose, const Motion<T>& motion, const Wrenches<T>& out) const {
  for (const FlowSpot<T>& spot : spots_) {
    const Floating f = floating(spot, pose);
    const Vec3<T>& x = f.drag.start;
    Vec3<T> gradient = f.drag.gradient(velocity_at(pose, motion, spot.body, x) - f.drag.flow);
    gradient.z() -= f.weight * share((f.level - x.z()) / f.radius);
    out.add(spot.body, x, gradient);
  }
}

template <class T>
std::size_t Buoyancy<T>::bytes() const {
  return sizeof *this + spots_.capacity() * sizeof(FlowSpot<T>) + in_step_.capacity() * sizeof(Floating);
}

template class Buoyancy<float>;
template class Buoyancy<double>;

}  // namespace sinew
