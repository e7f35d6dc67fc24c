#include "sinew/effects/wind.h"

namespace sinew {

template <class T>
Status Wind<T>::attach(const Skeleton& skeleton, const Tree<T>& /*tree*/) {
  if (!(settings.density >= 0) || !settings.velocity.allFinite())
    return Status::error(Code::kInvalidArgument, "wind needs a finite velocity and a density ≥ 0");
  if (Status status = flow_spots<T>(skeleton, settings.joints, spots_); !status) return status;
  drag_.resize(spots_.size());
  return {};
}

template <class T>
void Wind<T>::begin_step(const EffectPose<T>& start) {
  for (std::size_t n = 0; n < spots_.size(); ++n) {
    const FlowSpot<T>& spot = spots_[n];
    const Mat3<T>& turned = start.kinematics.rotation[spot.body];
    drag_[n].start = start.point(spot.body, spot.local);
    drag_[n].flow = settings.velocity.template cast<T>();
    drag_[n].spread = turned * spot.spread * turned.transpose();
    drag_[n].half_density = T(settings.density / 2);
  }
}

template <class T>
double Wind<T>::add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const {
  double energy = 0;
  for (std::size_t n = 0; n < spots_.size(); ++n) {
    const Vec3<T> x = pose.point(spots_[n].body, spots_[n].local);
    const Vec3<T> slip = drag_[n].slip(x, pose.h);
    energy += double(drag_[n].potential(slip, pose.h));
    out.add(spots_[n].body, x, drag_[n].gradient(slip));
  }
  return energy;
}

template <class T>
void Wind<T>::add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const {
  for (std::size_t n = 0; n < spots_.size(); ++n) {
    const Vec3<T> x = pose.point(spots_[n].body, spots_[n].local);
    const Vec3<T> slip = drag_[n].slip(x, pose.h);
    out.add(spots_[n].body, x, drag_[n].gradient(slip), drag_[n].change(slip, pose.h));
  }
}

template <class T>
void Wind<T>::add_load(const EffectPose<T>& pose, const Motion<T>& motion, const Wrenches<T>& out) const {
  for (const FlowSpot<T>& spot : spots_) {
    const Vec3<T> x = pose.point(spot.body, spot.local);
    const Mat3<T>& turned = pose.kinematics.rotation[spot.body];
    Drag<T> drag;
    drag.half_density = T(settings.density / 2);
    drag.spread = turned * spot.spread * turned.transpose();
    const Vec3<T> slip = velocity_at(pose, motion, spot.body, x) - settings.velocity.template cast<T>();
    out.add(spot.body, x, drag.gradient(slip));
  }
}

template <class T>
std::size_t Wind<T>::bytes() const {
  return sizeof *this + spots_.capacity() * sizeof(FlowSpot<T>) + drag_.capacity() * sizeof(Drag<T>);
}

template class Wind<float>;
template class Wind<double>;

}  // namespace sinew
