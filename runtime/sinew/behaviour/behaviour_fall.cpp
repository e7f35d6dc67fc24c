// A body that nothing keeps on its feet: it falls, lies, and gets up by a clip of its own.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sinew/behaviour/behaviour.h"
#include "sinew/character/grounding.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kLieStill = 0.1;              ///< m/s
constexpr double kTurnsStill = 0.3;            ///< rad/s, of the root
constexpr double kLie = 0.5, kNeverStill = 4;  ///< s; s after which it need not lie still

}  // namespace

template <class T>
void Behaviour<T>::fall(Character<T>& character, BehaviourReason reason, double number) {
  if (!waits_ && !is_rising()) stood_on_ = character.animation_ground().value_or(ground_);
  report_.state = BehaviourState::kFall;
  risen_ = walks_ = waits_ = false;
  landing_ = Landing::kNone;
  sets_off_ = 0;
  report_.fell_beyond = reason == BehaviourReason::kBeyondReach ? number : 0;
  report_.time = 0;
  rest_ = 0;
  reach_.begin();
  (void)character.set_root_drive(RootDrive::kFree);
  if (reason != BehaviourReason::kAsked) tell(BehaviourEventKind::kFallen, reason, number);
}

/// Whether it has lain still for a while.
template <class T>
bool Behaviour<T>::lies(const MeasuredBody& is, double h) {
  if (std::exchange(measured_, true))
    spin_ = rotation_log<double>(is.root.rotation * root_before_.conjugate()) / h;
  root_before_ = is.root.rotation;
  const double speed = is.mass.velocity.norm(), time = std::sqrt(unit_);
  const bool still = speed < kLieStill * time && spin_.norm() < kTurnsStill / time;
  rest_ = still ? rest_ + h : 0;
  return rest_ > kLie * time || report_.time > kNeverStill * time;
}

/// Arms reach for the ground; in the end all muscles have let go.
template <class T>
void Behaviour<T>::let_go(Character<T>& character, const MeasuredBody& world, double h) {
  FallingBody body;
  body.mass = world.mass;
  body.spin = character.displacement().turn() * spin_;
  body.forward = world.root.rotation * forward_;
  body.feet = from_above(world.foot[0].translation + world.foot[1].translation) / 2;
  body.ground = level_ + character.displacement().z;
  reach_.update(character, body, last_, h);
}

template <class T>
bool Behaviour<T>::may_get_up() const {
  if (!get_up_.possible() || settings_.get_up == GetUpPolicy::kNever) return false;
  return settings_.get_up == GetUpPolicy::kAuto || allowed_;
}

/// Falls, or lies and waits.
template <class T>
void Behaviour<T>::lie(Character<T>& character, std::span<JointJet<T>> jets, double h) {
  if (!std::exchange(asked_, true)) std::copy(jets.begin(), jets.end(), last_.begin());
  const bool falls = report_.state == BehaviourState::kFall;
  if (falls || reach_.acts()) {
    const MeasuredBody world = measure(character);
    if (falls && lies(world.without(character.displacement()), h)) report_.state = BehaviourState::kDown;
    if (reach_.acts()) let_go(character, world, h);
  }
  if (report_.state == BehaviourState::kDown && may_get_up() && get_up_.begin(character, level_)) {
    report_.state = BehaviourState::kGather;
    ++report_.tries;
    tell(BehaviourEventKind::kRising, allowed_ ? BehaviourReason::kAsked : BehaviourReason::kNone);
    return rise(character, jets, h);
  }
  std::copy(last_.begin(), last_.end(), jets.begin());
}

/// Gathers its limbs and gets up, by a clip of its own.
template <class T>
void Behaviour<T>::rise(Character<T>& character, std::span<JointJet<T>> jets, double h) {
  const GetUpOutcome outcome = get_up_.update(character, body_, last_, h);
  switch (outcome) {
    case GetUpOutcome::kGathers:
      report_.state = BehaviourState::kGather;
      break;
    case GetUpOutcome::kRises:
      report_.state = BehaviourState::kRise;
      break;
    case GetUpOutcome::kUp:
      return take_over(character, jets, h);
    case GetUpOutcome::kStuck:
      fall(character, BehaviourReason::kNotGathered, get_up_.off());
      break;
    case GetUpOutcome::kTooFar:
      fall(character, BehaviourReason::kLeftItsClip, get_up_.off());
      break;
    case GetUpOutcome::kTooLong:
      fall(character, BehaviourReason::kTookTooLong, report_.time);
      break;
  }
  asked_ = true;
  std::copy(last_.begin(), last_.end(), jets.begin());
}

/// Stands again: balanced over its feet, and from there on to the host's animation.
template <class T>
void Behaviour<T>::take_over(Character<T>& character, std::span<JointJet<T>> jets, double h) {
  report_ = {.state = BehaviourState::kBalance};
  risen_ = true;
  allowed_ = false;
  get_up_.forget();
  waits_ = clip_walks();
  if (waits_) {
    get_up_.stand(body_, jets);
    see_clip(character, jets);
  }
  tell(BehaviourEventKind::kStanding, BehaviourReason::kNone);
  swing_ = -1;
  const MeasuredBody world = measure(character);
  choose_support(world.without(character.displacement()));
  displace(character, to_feet());  // the animation faces as the body does
  const MeasuredBody is = world.without(character.displacement());
  spin_.setZero();
  root_before_ = is.root.rotation;
  measured_ = true;
  help_trunk(character);
  begin_plan(is, jets);
  move_plan(h);
  write_stance(jets, h);
  fade(jets, T(h));
  std::copy(jets.begin(), jets.end(), last_.begin());
}

template <class T>
Status Behaviour<T>::use_get_ups(const Skeleton& skeleton, std::span<const Clip> clips) {
  if (skeleton.joints.size() != last_.size())
    return Status::error(Code::kInvalidArgument, "not the skeleton of this behaviour");
  get_up_.prepare(skeleton, clips, settings_, unit_, weight_);
  return get_up_.possible() ? Status{} : Status::error(Code::kInvalidArgument, "no clip to get up by");
}

template <class T>
Status Behaviour<T>::get_up() {
  if (settings_.get_up == GetUpPolicy::kNever || !get_up_.possible())
    return Status::error(Code::kInvalidArgument, "it does not get up");
  allowed_ = true;
  return {};
}

template <class T>
void Behaviour<T>::knock_down(Character<T> character) {
  if (fallen()) return;
  report_.tries = 0;
  knocked_ = true;  // the next update tells
  fall(character, BehaviourReason::kAsked, 0);
}

template <class T>
void Behaviour<T>::stand(Character<T> character) {
  (void)character.set_activation(T(1));
  (void)character.set_self_collision(SelfCollision::kAsCreated);
  (void)character.set_root_drive(RootDrive::kGrounded);
  (void)character.set_help(-1, -1);
  report_ = {};
  allowed_ = waits_ = false;
  landing_ = Landing::kNone;
  sets_off_ = 0;
}

#define SINEW_FALL_INSTANCES(T)                                                         \
  template void Behaviour<T>::fall(Character<T>&, BehaviourReason, double);             \
  template bool Behaviour<T>::lies(const MeasuredBody&, double);                        \
  template void Behaviour<T>::let_go(Character<T>&, const MeasuredBody&, double);       \
  template bool Behaviour<T>::may_get_up() const;                                       \
  template void Behaviour<T>::lie(Character<T>&, std::span<JointJet<T>>, double);       \
  template void Behaviour<T>::rise(Character<T>&, std::span<JointJet<T>>, double);      \
  template void Behaviour<T>::take_over(Character<T>&, std::span<JointJet<T>>, double); \
  template Status Behaviour<T>::use_get_ups(const Skeleton&, std::span<const Clip>);    \
  template Status Behaviour<T>::get_up();                                               \
  template void Behaviour<T>::knock_down(Character<T>);                                 \
  template void Behaviour<T>::stand(Character<T>);
SINEW_FALL_INSTANCES(float)
SINEW_FALL_INSTANCES(double)

}  // namespace sinew
