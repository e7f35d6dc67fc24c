// A body that has got up while its animation walks: it stands, and sets off with a step of that walk.
#include <algorithm>
#include <cmath>

#include "sinew/animation/foot_placement_job.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/character/grounding.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kWaits = 3;                     ///< s on its feet, after which it sets off however it stands
constexpr double kStride = 2;                    ///< s, in which each foot of a walk has come down
constexpr double kSoonest = 0.4, kLatest = 0.7;  ///< s, in which it comes up to its animation
constexpr double kSetsOff = 0.6;                 ///< s, likewise, where no foot comes down for that
constexpr double kPlaced = 0.2;                  ///< s, in which its feet come under the rule of being placed
constexpr double kRises = 0.2;                   ///< s, half of the way up, as its legs let it
constexpr double kRests = 0.6;                   ///< m/s, of a point of a sole that rests
constexpr double kRestsWithin = 0.02;            ///< m, over the ground
constexpr double kFarthest = 0.6;                ///< m, of a foot that stands from its animation's

}  // namespace

/// Whether the clip rests on a foot, by its heel or its ball.
template <class T>
bool Behaviour<T>::clip_rests(std::size_t side) const {
  const FootLeg<T>& leg = body_.legs[side];
  for (const Vec3<T>& point : {leg.toe, leg.heel}) {
    const MovingVector<T> at = clip_foot_motion_[side] * still<T>(point);
    const bool low = double(at.z().value) < ground_ + kRestsWithin * unit_;
    if (low && double(rate_of<T>(at).norm()) < kRests * std::sqrt(unit_)) return true;
  }
  return false;
}

/// s, in which a body that stands comes up to its animation if it sets off now; 0 if it has to wait. A body
/// that gathers speed evenly is as far ahead as its animation comes on in half of that time. So it sets off
/// when the animation comes down on a foot so far ahead: it stands there already.
template <class T>
double Behaviour<T>::time_to_set_off() const {
  const double time = std::sqrt(unit_);
  if (!clip_walks() || report_.time > (kWaits + kStride) * time) return kSetsOff * time;
  for (std::size_t side = 0; side < 2; ++side) {
    const double takes = 2 * clip_foot_[side].dot(clip_velocity_) / clip_velocity_.squaredNorm();
    if (clip_rests(side) && takes > kSoonest * time && takes < kLatest * time) return takes;
  }
  return 0;
}

/// Stands as its get-up clip ends as long as it balances there, and then until it may set off.
template <class T>
void Behaviour<T>::wait(Character<T>& character, std::span<JointJet<T>> jets) {
  const bool stands = report_.state == BehaviourState::kClip && !fades_ && !fade_.running() &&
                      (!last_step_.root_unknown || report_.time > kWaits * std::sqrt(unit_));
  if (stands) {
    see_clip(character, jets);
    sets_off_ = time_to_set_off();
  }
  if (sets_off_ > 0)
    set_off(character);
  else
    get_up_.stand(body_, jets);
}

/// The host's animation, which was seen, begins behind the body and faces as it does.
template <class T>
void Behaviour<T>::set_off(Character<T>& character) {
  waits_ = false;
  get_up_.stand(body_, last_);
  const Vec2 is = from_above(body_.mass_of(last_, model_).place);
  const Quat<double> off = last_[0].rotation.template cast<double>() * clip_root_.conjugate();
  Displacement further;
  further.yaw = twist_angle<double>(off, Vec3<double>::UnitZ());
  const Vec2 begins = clip_body_ + sets_off_ / 2 * clip_velocity_;
  const Vec2 way = is - from_above(further.turn() * Vec3<double>(begins.x(), begins.y(), 0));
  further.x = way.x();
  further.y = way.y();
  further.z = ground_ - stood_on_;
  displace_led(character, further);
  last_[0] = displaced(further.inverse(), last_[0]);
  fades_ = fades_root_ = true;
  placed_ = {};
  lowered_ = {};
}

/// Who sets off does so step by step: a foot stays where it stands until its animation's leaves the ground,
/// and no sole goes below that. Joints alone, as they fade, would drag feet along and press them in.
template <class T>
void Behaviour<T>::place_feet(std::span<JointJet<T>> jets, T h) {
  std::array<FootInput<T>, 2> feet;
  for (std::size_t side = 0; side < 2; ++side) {
    const bool may_rest = placed_[side].locked() || fade_.running();
    feet[side].contact = T(may_rest && clip_rests(side) ? 1 : 0);
  }
  FootPlacementJob<T> job{body_.parents, jets, 0, body_.legs, feet, placed_, &lowered_};
  job.level = TimeJet<T>(T(stood_on_));
  job.step = h;
  job.settings.farthest = T(kFarthest * unit_);
  job.follow = T(0);  // the root stays with its fade
  job.rise = T(kRises * std::sqrt(unit_));
  (void)job.Run();
  lift_soles<T>(body_, T(stood_on_), jets);
  if (fade_.elapsed > T(0))
    placing_.elapsed += h;
  else
    (void)begin_inertial<T>(last_, jets, T(kPlaced * std::sqrt(unit_)), placing_);
  if (placing_.running()) (void)InertializeJob<T>{jets, &placing_, {}, jets}.Run();
  const auto on_clip = [](const FootState<T>& foot) {
    return !foot.locked() && foot.elapsed >= foot.duration;
  };
  if (fade_.running() || !on_clip(placed_[0]) || !on_clip(placed_[1])) return;
  sets_off_ = 0;
  fades_ = fades_root_ = true;
}

#define SINEW_SET_OFF_INSTANCES(T)                                         \
  template bool Behaviour<T>::clip_rests(std::size_t) const;               \
  template double Behaviour<T>::time_to_set_off() const;                   \
  template void Behaviour<T>::wait(Character<T>&, std::span<JointJet<T>>); \
  template void Behaviour<T>::set_off(Character<T>&);                      \
  template void Behaviour<T>::place_feet(std::span<JointJet<T>>, T);
SINEW_SET_OFF_INSTANCES(float)
SINEW_SET_OFF_INSTANCES(double)

}  // namespace sinew
