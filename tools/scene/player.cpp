#include "scene/player.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {

Transform<double> upright(const Vec3<double>& position, double yaw) {
  return {Quat<double>(Eigen::AngleAxisd(yaw, Vec3<double>::UnitZ())), position};
}

double heading(const Quat<double>& rotation, const Quat<double>& rest) {
  const Vec3<double> forward = (rotation * rest.conjugate()) * Vec3<double>::UnitX();
  return std::atan2(forward.y(), forward.x());
}

namespace {

/// Turn about the vertical that brings `from` nearest to `to`, also of bodies that lie: it maximises
/// tr(toᵀ·Rz·from).
double turn_between(const Quat<double>& from, const Quat<double>& to) {
  const Mat3<double> r = (to * from.conjugate()).toRotationMatrix();
  return std::atan2(r(1, 0) - r(0, 1), r(0, 0) + r(1, 1));
}

}  // namespace

template <class T>
Player<T>::Player(const SceneCharacter& c)
    : c_(c),
      places_(c.clips.size()),
      a_(c.asset->skeleton.joints.size()),
      b_(a_.size()),
      curves_(c.asset->curve_slots.size()),
      clip_curves_(curves_.size()) {
  for (auto& place : places_) place = upright(c.position, c.yaw);
  for (const ClipUse& use : c.clips) chosen_.push_back(use.clip);
  if (c.graph.graph) graph_.emplace(c.graph, upright(c.position, c.yaw));
}

template <class T>
bool Player<T>::moves() const {
  return graph_ || !c_.clips.empty() || c_.path.size() > 1 || !c_.turn_rate.empty() ||
         std::any_of(c_.pose.begin(), c_.pose.end(), [](const auto& p) { return p.second.size() > 1; });
}

template <class T>
const std::vector<JointJet<T>>& Player<T>::at(double t, const Felt<T>& felt) {
  if (!graph_) return at(t, felt.local);
  fault_ = graph_->at(t, felt, a_, curves_);
  return a_;
}

template <class T>
const std::vector<JointJet<T>>& Player<T>::at(double t, std::span<const Transform<T>> now) {
  if (graph_) return at(t, Felt<T>{now});
  stand(t, a_);
  for (std::size_t k = 0; k < curves_.size(); ++k) curves_[k] = TimeJet<T>(T(c_.asset->curve_slots[k].rest));
  bool any = false;
  for (std::size_t i = 0; i < c_.clips.size(); ++i) {
    const ClipUse& use = c_.clips[i];
    if (t < use.start - 1e-9) break;
    if (i >= begun_) begin(i, now);
    const bool over = i + 1 < c_.clips.size() && t >= c_.clips[i + 1].start + c_.clips[i + 1].blend;
    if (over) continue;
    if (use.from_pose) {
      for (std::size_t k = 0; k < a_.size(); ++k) {
        a_[k] = {};
        a_[k].rotation = held_[k].rotation;
        a_[k].translation = held_[k].translation;
      }
      any = true;
    }
    const Clip& clip = c_.asset->clips[chosen_[i]];
    const ClipTime time{use.offset + (t - use.start) * use.rate, use.rate};
    (void)SamplingJob<T>{&clip, time, b_}.Run();
    (void)CurveJob<T>{&clip, time, c_.asset->curve_slots, clip_curves_}.Run();
    place_root<T>(places_[i].template cast<T>(), b_[0]);
    const EaseWeight<T> w =
        any ? EaseWeight<T>::at(T(t - use.start), T(use.blend)) : EaseWeight<T>{T(1), T(0), T(0)};
    for (std::size_t k = 0; k < curves_.size(); ++k) curves_[k] += w * (clip_curves_[k] - curves_[k]);
    if (any)
      crossfade<T>(a_, b_, w, a_);
    else
      a_.swap(b_);
    any = true;
  }
  return a_;
}

template <class T>
std::vector<JointJet<T>> Player<T>::start(std::span<const Transform<T>> now) {
  std::vector<JointJet<T>> jets = at(0, now);
  if (c_.clips.empty() && !graph_)  // at rest: what it is driven along begins to move it in the first step
    for (JointJet<T>& jet : jets) jet.omega.setZero(), jet.velocity.setZero();
  add_speeds(c_.asset->skeleton, c_.speeds, jets);
  return jets;
}

/// Without a clip: at rest but for the pose, the path and the turning that the scene writes down.
template <class T>
void Player<T>::stand(double t, std::vector<JointJet<T>>& jets) const {
  const Skeleton& skeleton = c_.asset->skeleton;
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i] = {};
    jets[i].rotation = skeleton.joints[i].rest.rotation.template cast<T>();
    jets[i].translation = skeleton.joints[i].rest.translation.template cast<T>();
  }
  for (const auto& [joint, pose] : c_.pose) {
    const Vec3<double> turned = ramp_at(pose, t);
    bend(skeleton, jets, joint, turned);
    jets[joint].omega = (right_jacobian<double>(turned) * slope_at(pose, t)).template cast<T>();
  }
  const Vec3<double> position = c_.path.empty() ? c_.position : ramp_at(c_.path, t);
  const double turned = c_.turn_rate.empty() ? 0 : integral_at(c_.turn_rate, t);
  place_root<T>(upright(position, c_.yaw + turned).template cast<T>(), jets[0]);
  if (!c_.path.empty()) jets[0].velocity += slope_at(c_.path, t).template cast<T>();
  if (!c_.turn_rate.empty())
    jets[0].omega += jets[0].rotation.conjugate() * Vec3<T>(0, 0, T(ramp_at(c_.turn_rate, t)));
}

/// Chooses the clip by how the character lies and places it: its first root pose comes to stand where the
/// character's root is, turned the same way; heights stay.
template <class T>
void Player<T>::begin(std::size_t i, std::span<const Transform<T>> pose) {
  begun_ = i + 1;
  const ClipUse& use = c_.clips[i];
  if (use.from_pose) held_.assign(pose.begin(), pose.end());
  const Transform<double> now = pose[0].template cast<double>();
  const Quat<double> from_rest = now.rotation * c_.asset->skeleton.joints[0].rest.rotation.conjugate();
  const bool prone = (from_rest * Vec3<double>::UnitX()).z() < 0;
  if (prone && use.clip_when_prone >= 0) chosen_[i] = use.clip_when_prone;
  if (!use.align) return;
  (void)SamplingJob<T>{&c_.asset->clips[chosen_[i]], use.offset, b_}.Run();
  const double turn = turn_between(b_[0].rotation.template cast<double>(), now.rotation);
  const Transform<double> turned = upright(Vec3<double>::Zero(), turn);
  Vec3<double> shift = now.translation - turned * b_[0].translation.template cast<double>();
  shift.z() = c_.position.z();
  places_[i] = upright(shift, turn);
}

template class Player<float>;
template class Player<double>;

}  // namespace sinew::scene
