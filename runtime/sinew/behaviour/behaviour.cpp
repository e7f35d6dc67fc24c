#include "sinew/behaviour/behaviour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sinew/animation/soft_limits.h"
#include "sinew/character/grounding.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kMass = 75, kHipHeight = 0.95;          ///< kg, m
constexpr double kNoticed = 0.01, kNoticedSpeed = 0.08;  ///< m and m/s off the clip, that are a push
constexpr double kFade = 0.2;                            ///< s, from one plan's pose into the next
constexpr double kQuickFade = 0.1;                       ///< s, likewise of who walks: his feet land soon
constexpr double kTrunk = 0.25, kMostTrunk = 15;         ///< s and rad/s², in which the trunk comes upright
constexpr double kHeight = 0.12;                         ///< s, in which the body comes to its height
constexpr double kStraight = 0.985;                      ///< of a leg's length, that it reaches
constexpr double kStill = 0.05;                          ///< m/s
constexpr double kSame = 0.01;                           ///< m
constexpr double kOffSlope = 0.13;  ///< rad, of a slope from what the animation stands on, that topples it
constexpr double kFallen = 0.6;     ///< of the root's height
constexpr double kSquats = 0.4;     ///< likewise, while it lands
constexpr double kErrs = 5e-3;      ///< m, that a plan may take feet into the ground: none is exact
constexpr double kUpright = 0.77;   ///< cos 40°: who tilts further from the clip falls
constexpr double kOffPlan = 0.1, kOffPlanSpeed = 1;  ///< m, m/s: a plan that fails is made again
constexpr double kSeen = 0.03, kTrusted = 0.5;       ///< s; how far feet go by where the body is instead
constexpr double kDrop = 3, kRise = 12;        ///< m/s², of the body: feet that bear nothing can't press
constexpr double kLands = 0.2, kGivesIn = 25;  ///< s, m/s²: likewise of legs that take up a fall
constexpr double kUp = 0.03;                   ///< m below its height, at which they have
constexpr double kMisplaced = 0.03, kMisturned = 0.2;  ///< m, rad: a foot that is put back
constexpr double kFree = 0.003;                        ///< m over the ground: a foot that bears nothing
constexpr double kShifted = 0.15;                      ///< m/s, from which the other foot bears all
constexpr double kWalks = 0.25;                        ///< m/s, of an animation that does not stand
constexpr double kStops = 0.6;                         ///< of its pace: an animation that walks no longer
constexpr double kLifted = 0.03;                       ///< m over the other foot: one that is in the air
constexpr double kPatient = 0.5;                       ///< s
constexpr double kLed = 5e-3, kLedTime = 0.5;          ///< m and s, that tell who takes an animation along

Quat<double> upright(const Quat<double>& turned) {
  const double size = portable::hypot(turned.w(), turned.z());
  return size > 0 ? Quat<double>(turned.w() / size, 0, 0, turned.z() / size) : Quat<double>::Identity();
}

/// Of what goes along for h seconds, from one motion of a frame to the next.
Displacement way_of(const CarriedFrame& now, const CarriedFrame& next, double h) {
  const Displacement turn{0, 0, h * (now.turn_rate + next.turn_rate) / 2}, halfway{0, 0, turn.yaw / 2};
  const Vec3<double> chord = halfway.turn() * Vec3<double>(h * (now.velocity + next.velocity) / 2);
  const Vec3<double> way = now.place - turn.turn() * now.place + chord;
  return {way.x(), way.y(), turn.yaw, way.z()};
}

}  // namespace

template <class T>
Behaviour<T>::Behaviour(const Skeleton& skeleton, const BehaviourSettings& settings, Status& status)
    : settings_(settings) {
  for (const double share : {settings.fallen_strength, settings.reach_strength})
    if (!(share >= 0 && share <= 1))
      status = Status::error(Code::kInvalidArgument, "fallen_strength and reach_strength must be 0 to 1");
  if (status) status = body_.find(skeleton);
  if (!status) return;
  unit_ = std::max(body_.height / kHipHeight, 1e-6);
  weight_ = body_.total_mass / kMass;
  forward_ = skeleton.joints[0].rest.rotation.conjugate() * Vec3<double>::UnitX();
  for (double* length : {&law_.margin, &law_.longest_step, &law_.apart, &law_.lift}) *length *= unit_;
  for (double* time : {&law_.step_time, &law_.join_time}) *time *= std::sqrt(unit_);
  law_.gain /= std::sqrt(unit_);
  reach_.prepare(skeleton, settings_, unit_);
  const std::size_t joints = skeleton.joints.size();
  last_.resize(joints);
  model_.resize(joints);
  for (auto* numbers : {&fade_numbers_, &placing_numbers_})
    numbers->resize(inertial_numbers(static_cast<int>(joints), 1));  // the root's
  fade_ = {fade_numbers_, static_cast<int>(joints), 1};
  placing_ = {placing_numbers_, static_cast<int>(joints), 1};
}

template <class T>
MeasuredBody Behaviour<T>::measure(const Character<T>& character) const {
  MeasuredBody is;
  const std::span<const Transform<T>> model = character.model();
  const auto place = [&](int joint) {
    return model[static_cast<std::size_t>(joint)].template cast<double>();
  };
  is.mass = body_.mass_of(model);
  is.mass.velocity = last_step_.momentum / body_.total_mass - carried_.at(is.mass.place);
  is.root = place(0);
  for (std::size_t side = 0; side < 2; ++side) {
    is.foot[side] = place(body_.legs[side].foot);
    is.lowest[side] = body_.lowest_of(side, model);
  }
  return is;
}

template <class T>
Status Behaviour<T>::update(Character<T> character, std::span<JointJet<T>> jets, T h) {
  if (jets.size() != last_.size())
    return Status::error(Code::kInvalidArgument, "a behaviour needs one jet per joint of its skeleton");
  if (!character.valid()) return Status::error(Code::kInvalidArgument, "a behaviour needs a character");
  events_count_ = 0;
  if (std::exchange(knocked_, false)) tell(BehaviourEventKind::kFallen, BehaviourReason::kAsked);
  const bool restored = std::exchange(restored_, false);
  if (!restored) look_back(character);
  if (waits_) wait(character, jets);
  const bool acts =
      report_.state != BehaviourState::kClip || fades_ || fade_.running() || sets_off_ > 0 || waits_;
  if (!acts && !last_step_.root_unknown) {
    measured_ = asked_ = false;
    airborne_ = rises_ = 0;
    if (!last_step_.ground.moves()) {
      ground_before_ = {};
      return {};
    }
  } else if (!restored) {
    last_step_.momentum = character.report().momentum;
  }
  report_.time += double(h);
  see_clip(character, jets);
  see_ground(character, double(h));
  see_flight(double(h));
  if (acts || last_step_.root_unknown) act(character, jets, h);
  ride(character, jets[0], double(h));
  if (walks_) (void)character.keep_out(std::max(clip_presses_, kErrs * unit_));
  (void)character.set_self_collision(fallen()      ? SelfCollision::kOn   // nothing else keeps limbs apart
                                     : is_rising() ? SelfCollision::kOff  // clips do not know what is caught
                                                   : SelfCollision::kAsCreated);
  return {};
}

/// At what its character's last step has done, but for its momentum: who was played is not asked for it.
template <class T>
void Behaviour<T>::look_back(const Character<T>& character) {
  last_step_.ground = character.ground();
  last_step_.root_unknown = character.unknown()[0] != 0;
}

/// m/s of the clip's feet over ground of that velocity: of the point that slips least.
template <class T>
double Behaviour<T>::slip_over(const Vec3<double>& velocity) const {
  double least = std::numeric_limits<double>::max();
  for (std::size_t side = 0; side < 2; ++side)
    for (const SolePoint<T>& p : body_.soles[side]) {
      const Vec3<T> rate = rate_of<T>(model_[static_cast<std::size_t>(p.joint)] * still<T>(p.local));
      least = std::min(least, (rate.template cast<double>() - velocity).norm());
    }
  return least;
}

/// What bears the body, if the animation does not go along with it by itself. It gathers speed in the step to
/// come as it did in the last; who is in the air flies on.
template <class T>
void Behaviour<T>::see_ground(Character<T>& character, double h) {
  const BearingGround& ground = last_step_.ground;
  const CarriedFrame now{ground.place, ground.velocity, ground.turn_rate};
  const CarriedFrame before = ground.force > 0 ? std::exchange(ground_before_, now) : ground_before_;
  if (ground.force > 0 && !ground.normal.isZero(0)) {
    leveled_ = true;
    level_ = ground.place.z() - character.displacement().z;
    normal_ = character.displacement().turn().conjugate() * ground.normal;
  }
  carried_ = carried_next_ = ground_before_;
  if (!ground_before_.moves()) {
    slip_ridden_ = slip_led_ = 0;
    led_ = false;
    return;
  }
  const double fades = 1 - std::min(h / (kLedTime * std::sqrt(unit_)), 1.0);
  const Quat<double> back = character.displacement().turn().conjugate();
  slip_ridden_ = fades * (slip_ridden_ + h * slip_over(Vec3<double>::Zero()));
  slip_led_ = fades * (slip_led_ + h * slip_over(back * ground_before_.velocity));
  led_ = slip_led_ + (led_ ? -kLed : kLed) * unit_ < slip_ridden_;
  if (led_) {
    carried_ = carried_next_ = {};
  } else if (ground.force > 0 && before.moves()) {
    carried_next_.velocity += now.velocity - before.at(now.place);
    carried_next_.turn_rate += now.turn_rate - before.turn_rate;
  } else if (!before.moves() && last_step_.root_unknown) {  // as in the last step
    (void)character.displace(way_of(carried_, carried_, h));
  }
}

/// The animation goes along with ground that moves.
template <class T>
void Behaviour<T>::ride(Character<T>& character, JointJet<T>& root, double h) const {
  const CarriedFrame &now = carried_, &next = carried_next_;
  if (!now.moves()) return;
  (void)character.ride(way_of(now, next, h));
  const Displacement by = character.displacement();
  const Quat<double> back = by.turn().conjugate();
  const Vec3<double> is =
      by.turn() * root.translation.template cast<double>() + Vec3<double>(by.x, by.y, by.z);
  root.velocity += (back * next.at(is)).template cast<T>();
  root.acceleration += (back * ((next.at(is) - now.at(is)) / h)).template cast<T>();
  const Vec3<double> up = root.rotation.conjugate().template cast<double>() * Vec3<double>::UnitZ();
  root.omega += (next.turn_rate * up).template cast<T>();
  root.alpha += ((next.turn_rate - now.turn_rate) / h * up).template cast<T>();
}

template <class T>
void Behaviour<T>::act(Character<T>& character, std::span<JointJet<T>> jets, T h) {
  switch (report_.state) {
    case BehaviourState::kFall:
    case BehaviourState::kDown:
      return lie(character, jets, double(h));
    case BehaviourState::kGather:
    case BehaviourState::kRise:
      return rise(character, jets, double(h));
    default:
      break;
  }
  watch(character, jets, h);
  if (report_.state == BehaviourState::kFall) {
    std::copy(last_.begin(), last_.end(), jets.begin());
    return;
  }
  if (landing_ == Landing::kInAir)
    write_flight(jets);
  else if (walks_)
    write_walk(jets, double(h));
  else if (report_.state == BehaviourState::kBalance || report_.state == BehaviourState::kStep)
    write_stance(jets, double(h));
  fade(jets, h);
  if (asked_ && walks_) calm_legs(jets, h);
  std::copy(jets.begin(), jets.end(), last_.begin());
  asked_ = true;
}

/// From one plan's pose into the next. The root is solved for, and is where it is, but for that of who stands
/// again: he may be played, and his feet stand as long as root and legs go together.
template <class T>
void Behaviour<T>::fade(std::span<JointJet<T>> jets, T h) {
  if (std::exchange(fades_, false)) {
    for (JointJet<T>& now : last_) {  // a step later, as it went on
      now.rotation = now.rotation * rotation_exp<T>(Vec3<T>(h * now.omega + h * h / 2 * now.alpha));
      now.omega += h * now.alpha;
    }
    JointJet<T>& root = last_[0];
    root.translation += h * root.velocity + h * h / 2 * root.acceleration;
    root.velocity += h * root.acceleration;
    if (!fades_root_) root = jets[0];
    if (landing_ == Landing::kLands)  // legs give in at once
      for (const FootLeg<T>& leg : body_.legs)
        for (const int joint : {leg.upper, leg.middle, leg.foot})
          last_[static_cast<std::size_t>(joint)] = jets[static_cast<std::size_t>(joint)];
    const double time = sets_off_ > 0 ? sets_off_ : (walks_ ? kQuickFade : kFade) * std::sqrt(unit_);
    (void)begin_inertial<T>(last_, jets, T(time), fade_);
  } else {
    fade_.elapsed += h;
  }
  if (fade_.running()) {
    const JointJet<T> root = jets[0];
    (void)InertializeJob<T>{jets, &fade_, {}, jets}.Run();
    if (!fades_root_) jets[0] = root;
  }
  if (sets_off_ > 0) place_feet(jets, h);
}

/// What the animation does in this frame, and on which ground.
template <class T>
void Behaviour<T>::see_clip(const Character<T>& character, std::span<const JointJet<T>> jets) {
  const MassMotion clip = body_.mass_of(jets, model_);
  clip_velocity_ = from_above(clip.velocity);
  clip_acceleration_ = clip.acceleration;
  clip_body_ = from_above(clip.place);
  clip_root_ = jets[0].rotation.template cast<double>().normalized();
  clip_spin_ = clip_root_ * jets[0].omega.template cast<double>();
  Vec2 middle = Vec2::Zero();
  for (std::size_t side = 0; side < 2; ++side) {
    const MovingTransform<T>& ankle = model_[static_cast<std::size_t>(body_.legs[side].foot)];
    clip_foot_motion_[side] = ankle;
    clip_ankle_[side].translation = value_of(ankle.translation).template cast<double>();
    clip_ankle_[side].rotation = ankle.rotation.value.template cast<double>().normalized();
    clip_foot_[side] = from_above(clip_ankle_[side].translation) - clip_body_;
    middle += from_above(clip_ankle_[side].translation) / 2;
  }
  // Before it has borne anything: under its soles, as flat as they are at rest. As it was while it catches
  // itself: what it is led over then is not where its animation is.
  const std::optional<double> known = character.animation_ground();
  if (!walks_)
    ground_ =
        known ? *known : std::min(body_.lowest_of(0, clip_ankle_[0]), body_.lowest_of(1, clip_ankle_[1]));
  if (!leveled_) level_ = ground_;
  const std::span<const MovingTransform<T>> model(model_);
  clip_presses_ = std::max(ground_ - std::min(body_.lowest_of(0, model), body_.lowest_of(1, model)), 0.0);
  from_clip_ = clip_body_ - middle;
  // A host may have turned feet to the ground: what they stand on is level, or sloped as the ground is,
  // whichever their soles are nearer to.
  Vec3<double> up = Vec3<double>::Zero();
  for (std::size_t side = 0; side < 2; ++side) up += clip_ankle_[side].rotation * body_.sole_up[side];
  clip_normal_ = up.dot(normal_) > up.z() ? normal_ : Vec3<double>::UnitZ();
}

template <class T>
bool Behaviour<T>::clip_walks() const {
  return clip_velocity_.norm() > kWalks * std::sqrt(unit_);
}

/// Whether something has pushed the body off its animation, or off what it is asked to do on its way back
/// there.
template <class T>
bool Behaviour<T>::is_pushed(const MeasuredBody& is, double h) {
  Vec2 place = clip_body_ - h * clip_velocity_, velocity = clip_velocity_;
  if (fade_.running() || sets_off_ > 0) {
    const MassMotion asked = body_.mass_of(last_, model_);
    place = from_above(asked.place);
    velocity = from_above(asked.velocity);
  }
  const Vec2 off = from_above(is.mass.place) - place, faster = from_above(is.mass.velocity) - velocity;
  return off.norm() > kNoticed * unit_ || faster.norm() > kNoticedSpeed * std::sqrt(unit_);
}

/// Decides what to do in this frame, and moves the plan to its end.
template <class T>
void Behaviour<T>::watch(Character<T>& character, std::span<const JointJet<T>> jets, T step) {
  const auto h = static_cast<double>(step);
  const MeasuredBody world = measure(character), is = world.without(character.displacement());
  const bool known = std::exchange(measured_, true);
  spin_ = known ? Vec3<double>(rotation_log<double>(is.root.rotation * root_before_.conjugate()) / h)
                : Vec3<double>::Zero();
  root_before_ = is.root.rotation;
  const bool has_plan = report_.state == BehaviourState::kBalance || report_.state == BehaviourState::kStep;
  if (last_step_.root_unknown && clip_walks() && !has_plan) (void)character.give_hand();
  if (report_.state == BehaviourState::kClip) {
    // Who is back in a walk, or sets off, is led: no ground gives all that the way there asks for.
    if (fade_.running() && fades_root_ && clip_walks()) (void)character.come_back();
    if (!last_step_.root_unknown || !(flies() || is_pushed(is, h))) return;
    report_ = {.state = BehaviourState::kPassive};
    return;
  }
  const Quat<double> tilt = is.root.rotation * jets[0].rotation.template cast<double>().conjugate();
  const double high = is.root.translation.z() - level_;
  if ((high < (landing_ == Landing::kLands ? kSquats : kFallen) * body_.height && !flies()) ||
      (tilt * Vec3<double>::UnitZ()).z() < kUpright)
    return fall(character, BehaviourReason::kTilted, high);
  const bool reacts = report_.state == BehaviourState::kPassive;
  if (reacts) {
    if (!last_step_.root_unknown) return give_up(character);
    if (report_.time < settings_.reaction) return;
    if (report_.time - h < settings_.reaction)  // the first time
      help_trunk(character);
    if (clip_walks()) return begin_walk(character, world, jets, h);
    if (!flies()) begin_plan(is, jets);
  }
  if (flies()) return fly(is, jets, h);
  if (landing_ == Landing::kInAir) land(is, jets);
  if (landing_ == Landing::kLanded) end_step(is, jets);  // its feet stand where they came down
  if (landing_ == Landing::kLands) give_in(is, jets[0]);
  if (walks_ && clip_velocity_.norm() < kStops * pace_) stop_walking(character, is, jets);
  if (walks_) return walk_on(character, world, jets[0], h);
  if (report_.state == BehaviourState::kStep && swing_time_ >= swing_lasts_) end_step(is, jets);
  const Vec2 off = from_above(is.mass.place) - plan_.place,
             faster = from_above(is.mass.velocity) - plan_.velocity;
  if (off.norm() > kOffPlan * unit_ || faster.norm() > kOffPlanSpeed * std::sqrt(unit_)) {
    plan_.place = from_above(is.mass.place);
    plan_.velocity = from_above(is.mass.velocity);
  }
  const Vec2 ahead =
      from_above(is.mass.place + is.mass.velocity / frequency_) - plan_.capture_point(frequency_);
  ahead_ -= portable::expm1(-h / (kSeen * std::sqrt(unit_))) * (ahead - ahead_);
  if (report_.state == BehaviourState::kBalance) keep_balance(character, is, reacts);
  if (report_.state == BehaviourState::kBalance || report_.state == BehaviourState::kStep) move_plan(h);
}

/// The hand of who balances: it may keep the trunk up.
template <class T>
void Behaviour<T>::help_trunk(Character<T>& character) const {
  (void)character.set_help(0, weight_ * unit_ * settings_.help_torque);
}

/// While both feet stand: a step if pressing does not reach, or would reach far as it `reacts` to a push, and
/// else back to the animation.
template <class T>
void Behaviour<T>::keep_balance(Character<T>& character, const MeasuredBody& is, bool reacts) {
  const Vec2 capture = capture_point();
  const double speed = plan_.velocity.norm() / std::sqrt(unit_);
  report_.capture_depth = support_.depth(capture);
  if (landing_ == Landing::kLands && height_.rate < -kStill * std::sqrt(unit_))
    return;  // both legs are needed
  const auto leans = [&] {
    const Vec2 rest = goal();
    return support_.depth(rest + (capture - rest) / law_.functional) < 0;
  };
  if (report_.capture_depth < 0 || (reacts && leans())) {
    home_ = -1;
    const int left = settings_.most_steps - report_.steps;
    if (out_of_reach(-report_.capture_depth, frequency_, left, law_))
      return fall(character, BehaviourReason::kBeyondReach, -report_.capture_depth);
    return begin_step(is);
  }
  if (home_ >= 0) {
    if (only_.depth(capture) > law_.margin && speed < kShifted) put_back(is);
    return;
  }
  if (report_.capture_depth < 2 * law_.margin || speed > 2 * kStill) return;
  home_ = misplaced();
  if (home_ < 0) return may_finish(is) ? finish(character) : void();
  find_only();
}

/// The plan's, as far as the body is where its plan is.
template <class T>
Vec2 Behaviour<T>::capture_point() const {
  return plan_.capture_point(frequency_) + kTrusted * ahead_;
}

template <class T>
Vec2 Behaviour<T>::goal() const {
  if (home_ >= 0) return only_.middle();
  const Vec3<double> off = to_feet().turn() * Vec3<double>(from_clip_.x(), from_clip_.y(), 0);
  return from_above(foot_[0].translation + foot_[1].translation) / 2 + from_above(off);
}

/// Of the feet that stand.
template <class T>
void Behaviour<T>::find_support() {
  support_ = {};
  for (int side = 0; side < 2; ++side)
    if (side != swing_) body_.add_sole(side, foot_[static_cast<std::size_t>(side)], support_);
  support_.close();
}

/// Of the foot that stands while the other is put back.
template <class T>
void Behaviour<T>::find_only() {
  only_ = {};
  body_.add_sole(1 - home_, foot_[static_cast<std::size_t>(1 - home_)], only_);
  only_.close();
}

/// m, by which ground of that slope is higher so far away, seen from above.
template <class T>
double Behaviour<T>::rises_along(const Vec2& way) const {
  return -from_above(normal_).dot(way) / normal_.z();
}

/// Where the feet are now they stand, as flat as the clip's on ground of that slope. What bears them is as
/// much higher than what the clip stands on as the foot that is lowest tells while something bears the body.
template <class T>
void Behaviour<T>::choose_support(const MeasuredBody& is) {
  const Quat<double> slope = Quat<double>::FromTwoVectors(Vec3<double>::UnitZ(), normal_);
  const Quat<double> flat_clip = Quat<double>::FromTwoVectors(clip_normal_, Vec3<double>::UnitZ());
  double higher = std::numeric_limits<double>::max();
  for (std::size_t side = 0; side < 2; ++side) {
    if (static_cast<int>(side) == swing_) continue;
    Transform<double>& foot = foot_[side];
    const Transform<double>& clip = clip_ankle_[side];
    foot = is.foot[side];
    const Quat<double> flat = flat_clip * clip.rotation;
    foot.rotation = slope * upright(foot.rotation * flat.conjugate()) * flat;
    foot.translation.z() =
        clip.translation.z() + rises_along(from_above(foot.translation - clip.translation));
    higher = std::min(higher, is.lowest[side] - body_.lowest_of(side, foot));
  }
  higher += last_step_.ground.depth;
  if (last_step_.ground.force > 0) higher_ = std::abs(higher) < kOffGround * unit_ ? 0 : higher;
  for (std::size_t side = 0; side < 2; ++side)
    if (static_cast<int>(side) != swing_) foot_[side].translation.z() += higher_;
  find_support();
}

template <class T>
void Behaviour<T>::begin_plan(const MeasuredBody& is, std::span<const JointJet<T>> jets) {
  report_.state = BehaviourState::kBalance;
  landing_ = Landing::kNone;
  sets_off_ = 0;
  swing_ = home_ = -1;
  plan_ = {from_above(is.mass.place), from_above(is.mass.velocity)};
  ahead_.setZero();
  frequency_ = std::sqrt(settings_.gravity / std::max(is.mass.place.z() - level_, 0.3 * unit_));
  begin_trunk(is, jets[0]);
  choose_support(is);
  fades_ = true;
  fades_root_ = false;
}

template <class T>
void Behaviour<T>::begin_trunk(const MeasuredBody& is, const JointJet<T>& root) {
  const Quat<double> wanted = root.rotation.template cast<double>();
  turn_ = rotation_log<double>(is.root.rotation * wanted.conjugate());
  turn_rate_ = spin_;
  turn_acceleration_.setZero();
  height_ = {is.root.translation.z() - double(root.translation.z()), 0.0, 0.0};
}

template <class T>
Feet Behaviour<T>::feet_now(const Transform<double>& root) const {
  const Vec3<double> ahead = root.rotation * forward_;
  return {{from_above(foot_[0].translation), from_above(foot_[1].translation)},
          portable::atan2(ahead.y(), ahead.x())};
}

/// Whether a foot bears nothing, as of who is tipped over the other one, and stands away from it.
template <class T>
bool Behaviour<T>::can_join(int foot, const MeasuredBody& is) const {
  const auto side = static_cast<std::size_t>(foot);
  return is.lowest[side] - body_.lowest_of(side, foot_[side]) > kFree * unit_ &&
         from_above(foot_[0].translation - foot_[1].translation).norm() > law_.apart + kMisplaced * unit_;
}

/// What bears the body can't be lifted: where the other foot is free it first comes beside it and takes over,
/// as people's do.
template <class T>
void Behaviour<T>::begin_step(const MeasuredBody& is) {
  int foot = stepping_foot(feet_now(is.root), capture_point(), support_.middle(), law_);
  const bool joins = can_join(1 - foot, is);
  if (joins) foot = 1 - foot;
  ++report_.steps;
  lift(foot, foot_[static_cast<std::size_t>(foot)], is);
  if (joins) swing_lasts_ = law_.join_time;
}

/// A step with a foot, from where it is.
template <class T>
void Behaviour<T>::lift(int foot, const Transform<double>& from, const MeasuredBody& is) {
  report_.state = BehaviourState::kStep;
  swing_ = foot;
  swing_time_ = 0;
  swing_lasts_ = law_.step_time;
  lifted_ = from;
  choose_support(is);
}

/// Its animation stops while it catches itself: it balances from here on, over the foot that stands.
template <class T>
void Behaviour<T>::stop_walking(Character<T>& character, const MeasuredBody& is,
                                std::span<const JointJet<T>> jets) {
  walks_ = false;
  help_trunk(character);
  begin_plan(is, jets);
  const auto stands = static_cast<std::size_t>(stance_), swings = 1 - stands;
  const bool lifted = is.foot[swings].translation.z() > is.foot[stands].translation.z() + kLifted * unit_;
  report_.steps = lifted ? 1 : 0;
  if (lifted) lift(static_cast<int>(swings), is.foot[swings], is);
}

/// The foot goes where the clip has it beside the other.
template <class T>
void Behaviour<T>::put_back(const MeasuredBody& is) {
  const auto side = static_cast<std::size_t>(home_), stance = 1 - side;
  lift(home_, foot_[side], is);
  const Quat<double> turn = foot_[stance].rotation * clip_ankle_[stance].rotation.conjugate();
  foot_[side].translation =
      foot_[stance].translation + turn * (clip_ankle_[side].translation - clip_ankle_[stance].translation);
  foot_[side].rotation = turn * clip_ankle_[side].rotation;
}

template <class T>
void Behaviour<T>::end_step(const MeasuredBody& is, std::span<const JointJet<T>> jets) {
  swing_ = home_ = -1;
  const Vec3<double> turn = turn_, rate = turn_rate_, acceleration = turn_acceleration_;
  const TimeJet<double> height = height_;
  begin_plan(is, jets);
  turn_ = turn;
  turn_rate_ = rate;
  turn_acceleration_ = acceleration;
  height_ = height;
}

template <class T>
void Behaviour<T>::move_plan(double h) {
  const Vec2 pressed = press(
      plan_, frequency_, swing_ < 0 || home_ >= 0 ? goal() : plan_.capture_point(frequency_), support_, law_);
  plan_.advance(pressed, frequency_, h);
  if (swing_ >= 0) move_swing(h);
  move_trunk(h);
}

/// The trunk comes upright, critically damped.
template <class T>
void Behaviour<T>::move_trunk(double h) {
  const double time = kTrunk * std::sqrt(unit_);
  const Vec3<double> off = turn_ - Vec3<double>(0, 0, walks_ ? 0 : to_feet().yaw);
  Vec3<double> acceleration = -off / (time * time) - 2 / time * turn_rate_;
  if (const double size = acceleration.norm(); size > kMostTrunk / unit_)
    acceleration *= kMostTrunk / unit_ / size;
  turn_acceleration_ = acceleration;
  turn_ += h * turn_rate_ + h * h / 2 * acceleration;
  turn_rate_ += h * acceleration;
}

/// The foot in the air goes to where the capture point will be.
template <class T>
void Behaviour<T>::move_swing(double h) {
  swing_time_ += h;
  const auto side = static_cast<std::size_t>(swing_);
  if (home_ >= 0 && support_.depth(capture_point()) < 0) home_ = -1;  // it has to catch the body
  if (home_ >= 0 || swing_time_ > 0.8 * swing_lasts_) return;         // it keeps its landing place
  const Vec2 capture = capture_point();
  const Vec2 lands = capture_point_after(capture, frequency_, swing_lasts_ - swing_time_, support_);
  const Vec2 to = within_reach(feet_now({root_before_, {}}), swing_, lands + clip_foot_[side], law_);
  foot_[side].translation.z() += rises_along(to - from_above(foot_[side].translation));
  foot_[side].translation.x() = to.x();
  foot_[side].translation.y() = to.y();
}

/// Of the body and its trunk, without height and feet.
template <class T>
Stance Behaviour<T>::planned() const {
  Stance stance;
  stance.body = plan_.place;
  stance.body_velocity = plan_.velocity;
  stance.body_acceleration = plan_.acceleration;
  for (int a = 0; a < 3; ++a) stance.turn[a] = {turn_[a], turn_rate_[a], turn_acceleration_[a]};
  return stance;
}

template <class T>
void Behaviour<T>::write_stance(std::span<JointJet<T>> jets, double h) {
  Stance stance = planned();
  for (std::size_t side = 0; side < 2; ++side) {
    stance.ankle[side] = still<double>(foot_[side].translation);
    stance.foot[side] = foot_[side].rotation;
    if (static_cast<int>(side) != swing_) continue;
    const double time = swing_lasts_;
    const TimeJet<double> u{std::clamp(swing_time_ / time, 0.0, 1.0),
                            swing_time_ > 0 && swing_time_ < time ? 1 / time : 0, 0};
    const TimeJet<double> share = soft_step(u);
    const TimeJet<double> back = TimeJet<double>(1) - u, bump = u * back;
    const TimeJet<double> up = TimeJet<double>(64 * law_.lift) * bump * bump * bump;
    const Vec3<double> way = foot_[side].translation - lifted_.translation;
    for (int a = 0; a < 3; ++a)
      stance.ankle[side][a] = TimeJet<double>(lifted_.translation[a]) + way[a] * share;
    stance.ankle[side][2] += up;
    stance.foot[side] = lifted_.rotation *
                        rotation_exp<double>(share.value * rotation_log<double>(lifted_.rotation.conjugate() *
                                                                                foot_[side].rotation));
  }
  move_height({value_of(stance.ankle[0]), value_of(stance.ankle[1])}, plan_.place - clip_body_, to_feet().z,
              h);
  stance.height = height_;
  take_stance<T>(body_, stance, jets, model_);
}

/// As high over its ground as the clip, but no higher than straight legs reach. `shift`: of the root, from
/// the clip's; `higher` (m): the ground, than the clip's.
template <class T>
void Behaviour<T>::move_height(const std::array<Vec3<double>, 2>& ankle, const Vec2& shift, double higher,
                               double h) {
  double lower = higher;
  for (std::size_t side = 0; side < 2; ++side) {
    const FootLeg<T>& leg = body_.legs[side];
    const Vec3<double> hip =
        value_of(model_[static_cast<std::size_t>(leg.upper)].translation).template cast<double>();
    const Vec2 across = from_above(ankle[side]) - (from_above(hip) + shift);
    const double length = kStraight * body_.leg_length[side];
    const double up = std::sqrt(std::max(length * length - across.squaredNorm(), 0.04 * length * length));
    lower = std::min(lower, ankle[side].z() + up - hip.z());
  }
  const bool lands = landing_ == Landing::kLands;
  const double time = (lands ? kLands : kHeight) * std::sqrt(unit_);
  height_.acceleration = std::clamp((lower - height_.value) / (time * time) - 2 / time * height_.rate, -kDrop,
                                    lands ? kGivesIn : kRise);
  if (lands) height_.acceleration += yields_;
  height_.value += h * height_.rate + h * h / 2 * height_.acceleration;
  height_.rate += h * height_.acceleration;
  if (lands && lower - height_.value < kUp * unit_ && height_.rate > -kStill * std::sqrt(unit_))
    landing_ = Landing::kLanded;
}

template <class T>
bool Behaviour<T>::may_finish(const MeasuredBody& is) const {
  // Who has just got up need not stand as well as it would like to.
  const double patience = risen_ ? 1 + std::max(report_.time - kPatient, 0.0) / kPatient : 1;
  // Its animation would not stand here: it goes on to balance.
  if ((normal_ - clip_normal_).norm() > kOffSlope) return false;
  return swing_ < 0 && landing_ == Landing::kNone && !fade_.running() &&
         from_above(is.mass.velocity).norm() < patience * kStill / 2 * std::sqrt(unit_) &&
         (from_above(is.mass.place) - goal()).norm() < patience * kSame / 2 * unit_ &&
         (turn_ - Vec3<double>(0, 0, to_feet().yaw)).norm() < patience * 0.02;
}

/// What takes the clip's feet under those that stand.
template <class T>
Displacement Behaviour<T>::to_feet() const {
  const Vec2 stands = from_above(foot_[0].translation) - from_above(foot_[1].translation),
             clip = clip_foot_[0] - clip_foot_[1];
  Displacement further;
  further.yaw = portable::atan2(clip.x() * stands.y() - clip.y() * stands.x(), clip.dot(stands));
  const Vec2 middle = clip_body_ - from_clip_,
             from = from_above(further.turn() * Vec3<double>(middle.x(), middle.y(), 0)),
             to = from_above(foot_[0].translation + foot_[1].translation) / 2;
  further.x = to.x() - from.x();
  further.y = to.y() - from.y();
  for (std::size_t side = 0; side < 2; ++side)
    further.z += (foot_[side].translation.z() - clip_ankle_[side].translation.z()) / 2;
  return further;
}

/// The foot that stands elsewhere than the clip has it by the other, and is better put back; -1: neither.
template <class T>
int Behaviour<T>::misplaced() const {
  const Vec2 stands = from_above(foot_[0].translation) - from_above(foot_[1].translation);
  const Vec2 clip = clip_foot_[0] - clip_foot_[1];
  const auto yaw_of = [&](std::size_t side) {
    return rotation_log<double>(foot_[side].rotation * clip_ankle_[side].rotation.conjugate()).z();
  };
  const bool apart = std::abs(stands.norm() - clip.norm()) > kMisplaced * unit_;
  const double line = to_feet().yaw;
  if (!apart && std::abs(yaw_of(0) - line) < kMisturned && std::abs(yaw_of(1) - line) < kMisturned) return -1;
  return (from_above(foot_[0].translation) - plan_.place).norm() >
                 (from_above(foot_[1].translation) - plan_.place).norm()
             ? 0
             : 1;
}

/// What `further`, in the frame in which targets are given, is in the world's.
template <class T>
Displacement Behaviour<T>::in_world(const Character<T>& character, const Displacement& further) {
  const Displacement by = character.displacement();
  return by.inverse().then(further).then(by);
}

/// Moves the animation by what `further` is in the frame in which targets are given.
template <class T>
void Behaviour<T>::displace(Character<T>& character, const Displacement& further) {
  (void)character.displace(in_world(character, further));
  see_ground_from(further);
}

/// The same of who is led.
template <class T>
void Behaviour<T>::displace_led(Character<T>& character, const Displacement& further) {
  (void)character.displace_led(in_world(character, further));
  see_ground_from(further);
}

/// The ground is where it was; `further` on is the frame in which it is known.
template <class T>
void Behaviour<T>::see_ground_from(const Displacement& further) {
  level_ -= further.z;
  normal_ = further.turn().conjugate() * normal_;
}

/// The clip again, from where the feet stand now, as the plan does already.
template <class T>
void Behaviour<T>::finish(Character<T>& character) {
  const Displacement further = to_feet();
  displace_led(character, further);
  last_[0] = displaced(further.inverse(), last_[0]);
  risen_ = false;
  return_to_clip(character);
}

/// The animation again, where it is, from what was asked of the body so far.
template <class T>
void Behaviour<T>::return_to_clip(Character<T>& character) {
  give_up(character);
  fades_ = fades_root_ = true;
}

/// The animation again, where it is.
template <class T>
void Behaviour<T>::give_up(Character<T>& character) {
  walks_ = false;
  landing_ = Landing::kNone;
  higher_ = 0;
  (void)character.set_help(-1, -1);
  report_.state = BehaviourState::kClip;
}

template <class T>
void Behaviour<T>::tell(BehaviourEventKind kind, BehaviourReason reason, double number) {
  if (events_count_ < events_.size()) events_[events_count_++] = {kind, reason, number};
}

template class Behaviour<float>;
template class Behaviour<double>;

}  // namespace sinew
