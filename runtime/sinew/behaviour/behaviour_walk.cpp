// A body that was pushed while it walked, and walks on: its feet land where they catch it.
//
// What it is off its animation, e = x − x̂, is an inverted pendulum as the body itself is, e'' = ω²(e − p), p
// what its feet press elsewhere than the animation's. The foot in the air lands by the capture point of e at
// that moment elsewhere, and the animation is displaced under the foot that stands: of e is left what
// e + e'/ω = 0 takes away by itself (Raibert, "Legged robots that balance", 1986; Pratt et al. 2006). Where
// that is out of reach the foot lands sooner than the animation's, and stands where its animation's will.
#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/behaviour/behaviour.h"
#include "sinew/character/grounding.h"
#include "sinew/character/return_to_animation.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kChanges = 0.7;  ///< of the standing foot's speed, at which the other one stands
constexpr double kStepTime = 0.5, kStepPace = 1.3;  ///< s, at that many m/s
constexpr double kLonger = 0.4;                     ///< m, than its animation's step
constexpr double kCrosses = 0.15;                   ///< m, that a foot may land further to the other side
constexpr double kSoonest = 0.05;                   ///< s, in which a foot can land
constexpr int kMoments = 8;                         ///< at which it might
constexpr double kMisses = 0.02;                    ///< m, that make another one worth it
constexpr double kShares = 3, kQuickest = 0.06;     ///< of that time, s: in which it goes elsewhere
constexpr double kClears = 0.04, kLifts = 0.04;     ///< m and s: by and in which it is lifted, not to stumble
constexpr double kYields = 0.08;     ///< s, in which a foot is asked to be where it came to stand
constexpr double kObserved = 0.4;    ///< s, in which what it plans comes to what it does
constexpr double kRises = 0.08;      ///< s, likewise of its height
constexpr double kAirborne = 0.03;   ///< s that nothing bears it, from which its animation sinks with it
constexpr double kSags = 0.02;       ///< m, that it may be lower than that before, or a foot higher
constexpr double kSameLevel = 5e-3;  ///< m, that ground may be higher or lower than its animation's
constexpr double kPresses = 0.1;     ///< m, that its feet press elsewhere than its animation's
constexpr double kReaches = 0.02;    ///< m, that an animation's soles may be over what bears them
// What a leg may be asked to arrive with in a frame: so many times its mean, and rad/s more.
constexpr double kTurnsBack = 3, kWhips = 10;
// What it may be off when it is led back, and more by this share for every step after the second.
constexpr double kNearly = 0.04, kNearlySpeed = 0.12, kLater = 0.25;  ///< m, m/s
constexpr double kNearlyPace = 0.1;                                   ///< of its pace: the same of who runs

constexpr double kOnTime = std::numeric_limits<double>::infinity();  ///< s: when its animation's does

/// m/s, level.
template <class T>
double speed_of(const MovingTransform<T>& foot) {
  return from_above(rate_of(foot.translation).template cast<double>()).norm();
}

/// s, from one landing to the next: steps get longer and quicker with the pace (Grieve and Gear, "The
/// relationships between length of stride, step frequency, time of swing and speed of walking", 1966).
double step_time(double pace, double unit) {
  const double time = std::sqrt(unit);
  return kStepTime * time * portable::cbrt(kStepPace * time / std::max(pace, 0.1 * time));
}

/// m and m/s, upwards, of a target a step before it.
template <class T>
TimeJet<double> height_before(const JointJet<T>& target, double h) {
  const double rate = double(target.velocity.z()), acceleration = double(target.acceleration.z());
  return {double(target.translation.z()) - h * rate + h * h / 2 * acceleration, rate - h * acceleration,
          acceleration};
}

/// Critically damped, h seconds on, exact for any h.
void approach(TimeJet<double>& x, double to, double time, double h) {
  const double off = x.value - to, pull = x.rate + off / time, left = portable::exp(-h / time);
  x.value = to + left * (off + h * pull);
  x.rate = left * (x.rate - h / time * pull);
  x.acceleration = (to - x.value) / (time * time) - 2 / time * x.rate;
}

}  // namespace

/// Of the clip, where the last step has ended.
template <class T>
Vec2 Behaviour<T>::clip_ankle_now(std::size_t side, double h) const {
  const MovingVector<T>& ankle = clip_foot_motion_[side].translation;
  return from_above(Vec3<double>((value_of(ankle) - T(h) * rate_of(ankle)).template cast<double>()));
}

/// What brings the clip's standing foot to where that foot stands: what the body is off from there is what
/// its next steps have to catch.
template <class T>
Displacement Behaviour<T>::to_standing_foot(const MeasuredBody& is, double h) const {
  const auto stands = static_cast<std::size_t>(stance_);
  const Vec2 way = from_above(is.foot[stands].translation) - (early_ ? lands_ : clip_ankle_now(stands, h));
  return {way.x(), way.y(), 0, 0};
}

/// The other foot stands. What is asked of the body does not leap: a foot that something kept from landing
/// where it should is led to where it is.
template <class T>
void Behaviour<T>::change_feet(Character<T>& character, const MeasuredBody& world, double h) {
  stance_ = 1 - stance_;
  ++report_.steps;
  swung_ = false;
  lands_in_ = kOnTime;
  const Displacement further = to_standing_foot(world.without(character.displacement()), h);
  displace_led(character, further);
  const Vec2 way(further.x, further.y);
  error_.place -= way;
  for (MovingVector<double>& offset : foot_offset_)
    for (int a = 0; a < 2; ++a) offset[a].value -= way[a];
}

template <class T>
void Behaviour<T>::begin_walk(Character<T>& character, const MeasuredBody& world,
                              std::span<const JointJet<T>> jets, double h) {
  report_.state = BehaviourState::kStep;
  walks_ = true;
  early_ = swung_ = comes_back_ = false;
  lands_in_ = kOnTime;
  sunk_ = 0;
  sets_off_ = 0;
  pace_ = clip_velocity_.norm();
  stance_ = speed_of(clip_foot_motion_[0]) <= speed_of(clip_foot_motion_[1]) ? 0 : 1;
  displace(character, to_standing_foot(world.without(character.displacement()), h));
  const MeasuredBody is = world.without(character.displacement());
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec2 off = from_above(is.foot[side].translation) - clip_ankle_now(side, h);
    foot_offset_[side] = still<double>(Vec3<double>(off.x(), off.y(), 0));
  }
  error_ = {from_above(is.mass.place) - (clip_body_ - h * clip_velocity_),
            from_above(is.mass.velocity) - clip_velocity_};
  frequency_ = std::sqrt(settings_.gravity / std::max(is.mass.place.z() - ground_, 0.3 * unit_));
  begin_trunk(is, jets[0]);
  const TimeJet<double> wanted = height_before(jets[0], h);
  height_ = {is.root.translation.z() - wanted.value, is.mass.velocity.z() - wanted.rate, 0.0};
  fades_ = true;
  fades_root_ = false;
  walk_on(character, world, jets[0], h);
}

/// The animation goes along to the level that its body has come down to. While nothing bears the body it
/// sinks as far as the body does, so that its feet reach for lower ground.
template <class T>
void Behaviour<T>::follow_ground(Character<T>& character) {
  double down = 0;
  if (last_step_.ground.force > 0) {
    const double off = level_ - ground_ - sunk_, fallen = height_.value - sunk_;
    const bool other_level = std::abs(off) > kSameLevel * unit_ && std::abs(fallen) > std::abs(off) / 2 &&
                             (fallen < 0) == (off < 0);
    down = -sunk_ - (other_level ? off : 0);
    sunk_ = 0;
  } else if (airborne_ > kAirborne * std::sqrt(unit_)) {
    down = std::max(-height_.value - kSags * unit_, 0.0);
    sunk_ += down;
  }
  if (down == 0) return;
  (void)character.displace_led({0, 0, 0, -down});
  level_ += down;
  height_.value += down;
  for (MovingVector<double>& offset : foot_offset_) offset[2].value += down;
}

/// N, that its animation asks of no floor at all: in the air all, on the ground what it would have to pull or
/// grip for.
template <class T>
double Behaviour<T>::beyond_any_floor() const {
  const Vec3<double> force = body_.total_mass * (clip_acceleration_ + Vec3<double>(0, 0, settings_.gravity));
  const double lowest = std::min(body_.lowest_of(0, model_), body_.lowest_of(1, model_));
  if (lowest > ground_ + kReaches * unit_) return force.norm();
  const double slips = std::max(from_above(force).norm() - kGoodGrip * std::max(force.z(), 0.0), 0.0);
  return portable::hypot(slips, std::min(force.z(), 0.0));
}

template <class T>
void Behaviour<T>::walk_on(Character<T>& character, const MeasuredBody& world, const JointJet<T>& root,
                           double h) {
  if (!last_step_.root_unknown && comes_back_) return return_to_clip(character);
  const auto stands = static_cast<std::size_t>(stance_);
  const bool other_stands =
      speed_of(clip_foot_motion_[1 - stands]) < kChanges * speed_of(clip_foot_motion_[stands]);
  early_ = early_ && other_stands;  // until its animation's foot stands, too
  if (!early_ && (other_stands || lands_in_ <= 0)) {
    early_ = !other_stands;
    change_feet(character, world, h);
  }
  const MeasuredBody is = world.without(character.displacement());
  const double time = std::sqrt(unit_);
  const Vec2 off = from_above(is.mass.place) - (clip_body_ - h * clip_velocity_) - error_.place,
             faster = from_above(is.mass.velocity) - clip_velocity_ - error_.velocity;
  const double share = std::min(1.0, h / (kObserved * time));
  error_.place += share * off;
  error_.velocity += share * faster;
  const Quat<double> clip = rotation_exp<double>(Vec3<double>(-h * clip_spin_)) * clip_root_;
  turn_ += share * (rotation_log<double>(is.root.rotation * clip.conjugate()) - turn_);
  turn_rate_ += share * (spin_ - clip_spin_ - turn_rate_);
  const TimeJet<double> wanted = height_before(root, h);
  const double rises = std::min(1.0, h / (kRises * time));
  height_.value += rises * (is.root.translation.z() - wanted.value - height_.value);
  height_.rate += rises * (is.mass.velocity.z() - wanted.rate - height_.rate);
  follow_ground(character);
  (void)character.set_help(weight_ * settings_.walk_force + beyond_any_floor(),
                           weight_ * unit_ * settings_.walk_torque);
  const double late = 1 + kLater * std::max(report_.steps - 2, 0);
  comes_back_ =
      report_.steps > 0 && last_step_.ground.force > 0 && error_.place.norm() < late * kNearly * unit_ &&
      error_.velocity.norm() < late * std::max(kNearlySpeed * time, kNearlyPace * clip_velocity_.norm());
  if (comes_back_) (void)character.come_back();
  const Vec2 capture = error_.capture_point(frequency_);
  Vec2 pressed = 2 * capture;
  if (const double far = pressed.norm(); far > kPresses * unit_) pressed *= kPresses * unit_ / far;
  if (early_)  // its animation still presses where the other foot stands
    pressed += lands_ - clip_ankle_now(static_cast<std::size_t>(1 - stance_), 0);
  move_offset(world.without(character.displacement()), h);
  error_.advance(pressed, frequency_, h);
  move_trunk(h);
}

/// A foot goes to where it has to be on the ground in so many seconds, whatever its animation's does.
template <class T>
void Behaviour<T>::lead_foot(std::size_t side, const Vec2& to, double in, double h) {
  MovingVector<double>& offset = foot_offset_[side];
  const MovingVector<T>& clip = clip_foot_motion_[side].translation;
  const double time = std::max(in / kShares, kQuickest * std::sqrt(unit_));
  for (int a = 0; a < 2; ++a) {
    const TimeJet<double> goes{double(clip[a].value), double(clip[a].rate), double(clip[a].acceleration)};
    TimeJet<double> foot = offset[a] + goes;
    foot.value -= h * goes.rate;  // a step before
    foot.rate -= h * goes.acceleration;
    approach(foot, to[a], time, h);
    offset[a] = foot - goes;
  }
  approach(offset[2], ground_ - body_.lowest_of(side, clip_ankle_[side]), time, h);
}

/// Where and when the foot in the air lands, of which the animation's lands at `lands` in `left` seconds: by
/// as much elsewhere as the body will be off when it is down. Where that is out of reach, sooner.
template <class T>
Footfall Behaviour<T>::footfall(const Vec2& ahead, const Vec2& lands, double left,
                                double time_of_step) const {
  const auto stands = static_cast<std::size_t>(stance_), swings = 1 - stands;
  const Vec2 place = clip_ankle_now(stands, 0), step = lands - place, left_of(-ahead.y(), ahead.x());
  Feet feet{{}, portable::atan2(ahead.y(), ahead.x())};
  feet.place[stands] = place;
  BalanceLaw law = law_;
  law.longest_step = std::max(law.longest_step, step.norm() + kLonger * unit_);
  law.apart = std::min(law.apart, (swings == 0 ? 1 : -1) * step.dot(left_of)) - kCrosses * unit_;
  // Where the capture point of the animation will be then, from its landing place (Hof, "The 'extrapolated
  // center of mass' concept suggests a simple control of balance in walking", 2008).
  const double grows = portable::exp(frequency_ * time_of_step);
  const Vec2 beyond = step.dot(ahead) / (grows - 1) * ahead - step.dot(left_of) / (grows + 1) * left_of;
  const Vec2 capture = error_.capture_point(frequency_);
  Footfall best;
  double missed = std::numeric_limits<double>::max();
  for (int n = 0; n <= kMoments && missed > kMisses * unit_; ++n) {
    const double in = left + n * (kSoonest - left) / kMoments;
    const Vec2 wanted = place + portable::exp(frequency_ * (in - left)) * (step + beyond) - beyond +
                        portable::exp(frequency_ * in) * capture;
    const Vec2 lands_at = within_reach(feet, static_cast<int>(swings), wanted, law);
    const double misses = std::abs((lands_at - wanted).dot(ahead));
    if (misses > missed - kMisses * unit_) continue;
    best = {lands_at, in};
    missed = misses;
  }
  return best;
}

/// The foot in the air goes to where it will land, and is lifted on its way: a body that is lower than its
/// animation would stumble over the ground. The one that stands is asked to be where it is.
template <class T>
void Behaviour<T>::move_offset(const MeasuredBody& is, double h) {
  const auto stands = static_cast<std::size_t>(stance_), swings = 1 - stands;
  MovingVector<double>& offset = foot_offset_[swings];
  const auto stay = [&] {
    for (int a = 0; a < 2; ++a) offset[a] = TimeJet<double>(offset[a].value);
  };
  if (early_) {
    lead_foot(stands, lands_, 0, h);
    return stay();
  }
  const double lifts = kLifts * std::sqrt(unit_);
  for (int a = 0; a < 2; ++a) approach(foot_offset_[stands][a], 0, kYields * std::sqrt(unit_), h);
  approach(foot_offset_[stands][2], 0, lifts, h);
  const MovingVector<T>&stance = clip_foot_motion_[stands].translation,
        &swing = clip_foot_motion_[swings].translation;
  const double walks = std::max(clip_velocity_.norm(), 1e-3), time_of_step = step_time(walks, unit_);
  const Vec2 ahead = clip_velocity_ / walks;
  const Vec2 way = from_above(Vec3<double>((value_of(swing) - value_of(stance)).template cast<double>())),
             rate = from_above(Vec3<double>((rate_of(swing) - rate_of(stance)).template cast<double>()));
  const double speed = rate.dot(ahead), still_to_go = walks * time_of_step - way.dot(ahead);
  if (!(speed > walks)) {  // it still stands, or again: who stands on its toes lifts the rest of it
    const double higher = is.lowest[swings] - body_.lowest_of(swings, clip_ankle_[swings]);
    approach(offset[2], !swung_ && higher > kSags * unit_ ? higher : 0, lifts, h);
    lands_in_ = kOnTime;
    return stay();
  }
  swung_ = true;
  const double left = std::clamp(still_to_go / speed, kSoonest, time_of_step);
  lands_ = clip_ankle_now(stands, 0) + way + still_to_go * ahead;
  const Footfall next = footfall(ahead, lands_, left, time_of_step);
  if (lands_in_ < kOnTime || next.in < left - kSoonest) {
    lands_in_ = std::min(lands_in_ - h, next.in);
    return lead_foot(swings, next.place, std::max(lands_in_, 0.0), h);
  }
  approach(offset[2], kClears * unit_, lifts, h);
  const double time = std::max(left / kShares, kQuickest * std::sqrt(unit_));
  for (int a = 0; a < 2; ++a) approach(offset[a], next.place[a] - lands_[a], time, h);
}

template <class T>
void Behaviour<T>::write_walk(std::span<JointJet<T>> jets, double h) {
  std::array<MovingTransform<T>, 2> feet = clip_foot_motion_;
  std::array<Vec3<double>, 2> ankle;
  for (std::size_t side = 0; side < 2; ++side) {
    for (int a = 0; a < 3; ++a) {
      const TimeJet<double>& off = foot_offset_[side][a];
      feet[side].translation[a] =
          feet[side].translation[a] + TimeJet<T>(T(off.value), T(off.rate), T(off.acceleration));
    }
    ankle[side] = value_of(feet[side].translation).template cast<double>();
  }
  move_height(ankle, error_.place, 0, h);
  MovingVector<double> shift, turn;
  for (int a = 0; a < 2; ++a) shift[a] = {error_.place[a], error_.velocity[a], error_.acceleration[a]};
  shift[2] = height_;
  for (int a = 0; a < 3; ++a) turn[a] = {turn_[a], turn_rate_[a], turn_acceleration_[a]};
  take_feet<T>(body_, shift, turn, feet, jets);
}

/// A knee that is all but straight passes through any rate: as legs go in this frame, where that does not
/// lead them there, or not nearly as fast. They would arrive with it.
template <class T>
void Behaviour<T>::calm_legs(std::span<JointJet<T>> jets, T h) const {
  for (const FootLeg<T>& leg : body_.legs)
    for (const int joint : {leg.upper, leg.middle, leg.foot}) {
      const JointJet<T>& before = last_[static_cast<std::size_t>(joint)];
      JointJet<T>& now = jets[static_cast<std::size_t>(joint)];
      const Vec3<T> turned = rotation_log<T>(before.rotation.conjugate() * now.rotation);
      const T whips = T(kTurnsBack) * turned.norm() / h + T(kWhips / std::sqrt(unit_));
      if (!are_foreign<T>(turned, h * before.omega, h * now.omega) && now.omega.norm() < whips) continue;
      now.omega = turned / h;
      now.alpha.setZero();
    }
}

#define SINEW_WALK_INSTANCES(T)                                                                            \
  template Vec2 Behaviour<T>::clip_ankle_now(std::size_t, double) const;                                   \
  template Displacement Behaviour<T>::to_standing_foot(const MeasuredBody&, double) const;                 \
  template void Behaviour<T>::change_feet(Character<T>&, const MeasuredBody&, double);                     \
  template void Behaviour<T>::begin_walk(Character<T>&, const MeasuredBody&, std::span<const JointJet<T>>, \
                                         double);                                                          \
  template void Behaviour<T>::walk_on(Character<T>&, const MeasuredBody&, const JointJet<T>&, double);     \
  template double Behaviour<T>::beyond_any_floor() const;                                                  \
  template void Behaviour<T>::follow_ground(Character<T>&);                                                \
  template void Behaviour<T>::lead_foot(std::size_t, const Vec2&, double, double);                         \
  template Footfall Behaviour<T>::footfall(const Vec2&, const Vec2&, double, double) const;                \
  template void Behaviour<T>::move_offset(const MeasuredBody&, double);                                    \
  template void Behaviour<T>::write_walk(std::span<JointJet<T>>, double);                                  \
  template void Behaviour<T>::calm_legs(std::span<JointJet<T>>, T) const;
SINEW_WALK_INSTANCES(float)
SINEW_WALK_INSTANCES(double)

}  // namespace sinew
