#include "sinew/behaviour/get_up.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/soft_limits.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kStrong = 0.4;    ///< s, in which the muscles' strength comes back
constexpr double kSettles = 0.25;  ///< s: gathered, or as near as it will come
constexpr double kSame = 0.04;     ///< m: another pose has to be nearer by that
constexpr int kMostGathers = 3;
constexpr double kMayRise = 0.3, kLost = 0.35;  ///< m off the clip's pose
constexpr double kFull = 1.5, kWaits = 0.08;    ///< rate and m: see above
constexpr double kCaught = 1.5;                 ///< s, in which a limb that could not be gathered comes free
constexpr double kRateTime = 0.08;              ///< s, in which the clip's rate follows
constexpr double kMostWait = 0.8, kMostTime = 7;  ///< s
constexpr double kEndsWithin = 0.15;              ///< m
constexpr double kNearlyUp = 0.93;                ///< of the clip: from here on balance may take over
constexpr double kStraight = 0.05;                ///< m below its height at the clip's end: it stands
constexpr double kLevel = 0.02, kSteep = 0.06;    ///< rad, of a slope that is none; one to turn over on
constexpr double kSupported = 0.4,
                 kStands = 0.15;  ///< m, centre of mass off the feet: leans as its ground, or not
constexpr double kSoft = 0.005;   ///< m

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 - 15 * u + 6 * u * u);
}

/// From level ground to one with that normal.
Quat<double> slope_of(const Vec3<double>& normal) {
  return Quat<double>::FromTwoVectors(Vec3<double>::UnitZ(), normal);
}

/// World → the frame in which targets are given.
template <class T>
Transform<double> from_world(const Character<T>& character) {
  const Displacement back = character.displacement().inverse();
  return {back.turn(), {back.x, back.y, back.z}};
}

template <class T>
void put_at(const Displacement& place, double ground, const Quat<double>& slope, JointJet<T>& root) {
  const Quat<double> turn = slope * place.turn();
  const Quat<T>& rotation = turn.cast<T>();
  root.rotation = rotation * root.rotation;
  root.velocity = rotation * root.velocity;
  root.acceleration = rotation * root.acceleration;
  const Vec3<double> at = turn * Vec3<double>(root.translation.template cast<double>()) +
                          slope * Vec3<double>(place.x, place.y, 0) + Vec3<double>(0, 0, ground);
  root.translation = at.cast<T>();
}

}  // namespace

template <class T>
void GetUp<T>::prepare(const Skeleton& skeleton, std::span<const Clip> clips,
                       const BehaviourSettings& settings, double unit, double weight) {
  settings_ = settings;
  unit_ = unit;
  weight_ = weight;
  clips_.prepare(skeleton, clips, unit);
  const std::size_t joints = skeleton.joints.size();
  lies_.resize(joints);
  pose_.resize(joints);
  model_.resize(joints);
  moves_.resize(joints);
  is_.resize(clips_.points().count());
  wanted_.resize(is_.size());
  fade_numbers_.resize(inertial_numbers(static_cast<int>(joints), 0));
  fade_ = {fade_numbers_, static_cast<int>(joints), 0};
  fade_.duration = T(0);
}

/// What bears the body: its plane is the clip's ground.
template <class T>
void GetUp<T>::look_at_ground(const Character<T>& character, double ground) {
  ground_ = ground;
  normal_ = Vec3<double>::UnitZ();
  const BearingGround& bears = character.ground();
  if (!(bears.force > 0) || bears.normal.isZero(0)) return;
  const Transform<double> back = from_world(character);
  const Vec3<double> normal = back.rotation * bears.normal;
  if (from_above(normal).norm() < kLevel) return;
  normal_ = normal;
  const Vec3<double> at = back * bears.place;
  ground_ = at.z() + from_above(normal).dot(from_above(at)) / normal.z();
}

/// m, of the root over its ground.
template <class T>
double GetUp<T>::height(const Character<T>& character) const {
  const Vec3<double> root = character.model()[0].translation.template cast<double>(),
                     at = from_world(character) * root;
  return at.z() - ground_ + from_above(normal_).dot(from_above(at)) / normal_.z();
}

/// Where the body is, in the frame in which targets are given, over its ground.
template <class T>
void GetUp<T>::look(const Character<T>& character) {
  clips_.points().place(character.model(), is_);
  Transform<double> back = from_world(character);
  back.translation.z() -= ground_;
  const Quat<double> level = slope_of(normal_).conjugate();
  for (Vec3<double>& p : is_) p = level * (back * p);
}

template <class T>
GetUpChoice GetUp<T>::choose() const {
  return clips_.choose(is_, tried_, tried_ != 0 || from_above(normal_).norm() > kSteep);
}

template <class T>
bool GetUp<T>::begin(Character<T>& character, double ground) {
  look_at_ground(character, ground);
  look(character);
  GetUpChoice choice = choose();
  if (choice.entry < 0) {  // all failed: once more
    tried_ = 0;
    choice = choose();
  }
  gathers_ = 0;
  elapsed_ = strong_from_ = 0;
  return gather_to(character, choice);
}

template <class T>
bool GetUp<T>::gather_to(Character<T>& character, const GetUpChoice& choice) {
  if (choice.entry < 0) return false;
  (void)character.set_root_drive(RootDrive::kFree);
  ++gathers_;
  rises_ = false;
  entry_ = choice.entry;
  variant_ = clips_.entry(entry_).variant;
  place_ = choice.fit.place;
  waits_ = 0;
  const std::span<const Transform<T>> local = character.local();
  for (std::size_t i = 0; i < lies_.size(); ++i) {
    lies_[i] = {};
    lies_[i].rotation = local[i].rotation;
    lies_[i].translation = local[i].translation;
  }
  time_ = TimeJet<double>(clips_.entry(entry_).time);
  rate_change_ = 0;
  clips_.sample(variant_, ClipTime{time_}, pose_);
  lies_[0] = pose_[0];
  (void)begin_inertial<T>(lies_, pose_, T(settings_.gather * std::sqrt(unit_)), fade_);
  return true;
}

/// The clip's root where the clip is played.
template <class T>
void GetUp<T>::put(std::span<JointJet<T>> jets) const {
  put_at(place_, ground_, slope_of(normal_), jets[0]);
}

/// On a slope: back to the vertical, as far as the body is over its feet. In the clip's frame.
template <class T>
void GetUp<T>::lean(const StandingBody<T>& body, std::span<JointJet<T>> jets) {
  const Vec3<double> up = (slope_of(normal_) * place_.turn()).conjugate() * Vec3<double>::UnitZ();
  const Vec3<double> slope = rotation_log<double>(slope_of(up));
  if (slope.isZero(0)) return;
  const MassMotion mass = body.mass_of(jets, moves_);
  std::array<MovingTransform<T>, 2> feet;
  for (std::size_t side = 0; side < 2; ++side)
    feet[side] = moves_[static_cast<std::size_t>(body.legs[side].foot)];
  const MovingVector<double> middle =
      (cast_motion<double>(feet[0].translation) + cast_motion<double>(feet[1].translation)) *
      TimeJet<double>(0.5);
  TimeJet<double> square(0.0);  // m², of the centre of mass off the feet
  for (int axis = 0; axis < 2; ++axis) {
    const TimeJet<double> off =
        TimeJet<double>(mass.place[axis], mass.velocity[axis], mass.acceleration[axis]) - middle[axis];
    square += off * off;
  }
  const double far = kSupported * kSupported * unit_ * unit_, near = kStands * kStands * unit_ * unit_;
  const TimeJet<double> share =
      soft_step((TimeJet<double>(far) - square) * TimeJet<double>(1 / (far - near)));
  if (share.value == 0) return;
  const MovingVector<double> turn = still<double>(slope) * share;
  const MovingRotation<double> rotation = turned_by(turn);
  const MovingVector<double> arm = cast_motion<double>(moves_[0].translation) - middle;
  MovingVector<double> shift = rotation * arm - arm;
  // The leg whose foot is lower is as long as it was.
  const MovingVector<double> across =
      cast_motion<double>(feet[0].translation) - cast_motion<double>(feet[1].translation);
  const TimeJet<double> lower =
      across.x() * TimeJet<double>(up.x() / 2) + across.y() * TimeJet<double>(up.y() / 2);
  shift -= still<double>(up) * (share * soft_max<double>(lower, TimeJet<double>(0.0) - lower, kSoft * unit_));
  take_feet<T>(body, shift, turn, feet, jets);
}

template <class T>
void GetUp<T>::stand(const StandingBody<T>& body, std::span<JointJet<T>> jets) {
  const double end = double(clips_.variants()[static_cast<std::size_t>(variant_)].clip->duration);
  clips_.sample(variant_, ClipTime{end, 0, 0}, jets);
  lean(body, jets);
  put(jets);
}

template <class T>
GetUpOutcome GetUp<T>::fail(GetUpOutcome why) {
  tried_ |= 1u << variant_;
  return why;
}

template <class T>
GetUpOutcome GetUp<T>::update(Character<T>& character, const StandingBody<T>& body,
                              std::span<JointJet<T>> jets, double h) {
  elapsed_ += h;
  look(character);
  if (!rises_) return gather(character, jets, h);
  return rolls() ? roll(character, jets, h) : rise(character, body, jets, h);
}

template <class T>
GetUpOutcome GetUp<T>::gather(Character<T>& character, std::span<JointJet<T>> jets, double h) {
  const double before = strong_from_;
  strong_from_ += h / (kStrong * std::sqrt(unit_));
  if (before < 1)
    (void)character.set_activation(T(std::lerp(settings_.fallen_strength, 1.0, smooth(strong_from_))));
  fade_.elapsed += T(h);
  const Fit fit = clips_.fit(entry_, is_);
  off_ = fit.off;
  place_ = fit.place;
  std::copy(pose_.begin(), pose_.end(), jets.begin());
  const bool fades = fade_.running();
  if (fades) (void)InertializeJob<T>{jets, &fade_, {}, jets}.Run();
  put(jets);
  if (fades) return GetUpOutcome::kGathers;
  waits_ += h;
  if (waits_ < kSettles * std::sqrt(unit_)) return GetUpOutcome::kGathers;
  const GetUpChoice best = choose();
  const bool turned =
      best.entry >= 0 && clips_.entry(best.entry).variant != variant_ && best.fit.off < off_ - kSame * unit_;
  if (turned && gathers_ < kMostGathers && gather_to(character, best)) return GetUpOutcome::kGathers;
  if (off_ > kMayRise * unit_) return fail(GetUpOutcome::kStuck);
  begin_rise(character);
  return GetUpOutcome::kRises;
}

template <class T>
void GetUp<T>::begin_rise(Character<T>& character) {
  rises_ = true;
  waits_ = 0;
  caught_ = off_;
  (void)character.set_activation(T(1));
  (void)character.set_root_drive(RootDrive::kGrounded);
  (void)character.set_help(weight_ * settings_.rise_force, weight_ * unit_ * settings_.rise_torque);
}

/// The clip's time goes on, slower where the body is behind; critically damped.
template <class T>
void GetUp<T>::move_time(double h) {
  const double wanted = std::clamp(kFull - (off_ - caught_) / (kWaits * unit_), 0.0, 1.0) / std::sqrt(unit_);
  const double rate_time = kRateTime * std::sqrt(unit_);
  rate_change_ = (wanted - time_.rate) / (rate_time * rate_time) - 2 / rate_time * time_.acceleration;
  time_.acceleration += h * rate_change_;
  time_.rate = std::max(time_.rate + h * time_.acceleration, 0.0);
  time_.value += h * time_.rate;
  waits_ = wanted < 0.1 ? waits_ + h : 0;
  caught_ *= portable::exp(-h / (kCaught * std::sqrt(unit_)));
}

template <class T>
bool GetUp<T>::rolls() const {
  return clips_.variants()[static_cast<std::size_t>(variant_)].rolls;
}

/// Over onto another side, with the help that who rises has; then on from there.
template <class T>
GetUpOutcome GetUp<T>::roll(Character<T>& character, std::span<JointJet<T>> jets, double h) {
  off_ = caught_ = 0;
  move_time(h);
  clips_.sample(variant_, ClipTime{time_}, jets);
  put(jets);
  if (time_.value < double(clips_.variants()[static_cast<std::size_t>(variant_)].clip->duration))
    return GetUpOutcome::kGathers;
  tried_ |= 1u << variant_;
  gathers_ = 0;
  return gather_to(character, choose()) ? GetUpOutcome::kGathers : GetUpOutcome::kStuck;
}

template <class T>
GetUpOutcome GetUp<T>::rise(const Character<T>& character, const StandingBody<T>& body,
                            std::span<JointJet<T>> jets, double h) {
  clips_.sample(variant_, ClipTime{time_}, pose_);
  lean(body, pose_);
  clips_.place(pose_, model_, wanted_);
  off_ = fit_pose(clips_.points().mass(), wanted_, is_).off;
  const double end = double(clips_.variants()[static_cast<std::size_t>(variant_)].clip->duration);
  move_time(h);
  clips_.sample(variant_, ClipTime{time_}, jets);
  lean(body, jets);
  put(jets);
  if (off_ > kLost * unit_) return fail(GetUpOutcome::kTooFar);
  if (waits_ > kMostWait * std::sqrt(unit_) || elapsed_ > kMostTime * std::sqrt(unit_))
    return fail(GetUpOutcome::kTooLong);
  const double low = clips_.variants()[static_cast<std::size_t>(variant_)].end_height - height(character);
  const bool stands = time_.value >= kNearlyUp * end && low < kStraight * unit_;
  if (!stands || off_ > kEndsWithin * unit_) return GetUpOutcome::kRises;
  return GetUpOutcome::kUp;
}

template class GetUp<float>;
template class GetUp<double>;

}  // namespace sinew
