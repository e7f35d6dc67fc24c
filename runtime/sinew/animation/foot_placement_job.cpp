#include "sinew/animation/foot_placement_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/soft_limits.h"

namespace sinew {
namespace {

constexpr double kLongest = 0.9995;  ///< of a leg: where TwoBoneJob ends
constexpr double kSpare = 5e-4;      ///< of a leg, between the pelvis' reach and where TwoBoneJob slows down
constexpr double kSoftest = 1e-3;    ///< of a leg: the least that TwoBoneJob slows down in
constexpr double kWidth = 0.045;  ///< of a leg, in which the pelvis begins to come down: less, and knees jerk
constexpr double kRising = 0.023;  ///< of a leg, that what lets the pelvis rise slowly stays above it
constexpr double kFlattest = 0.2;  ///< of a leg: height of the hip that is left if a foot is far out
constexpr int kMostLegs = 8;

/// One leg while it is placed.
template <class T>
struct Placed {
  FootMotion<T> motion;
  FootTarget<T> target;
  LimbMotion<T> limb;
  MovingVector<T> pole;
  TimeJet<T> length;  ///< m
};

template <class T>
TimeJet<T> distance(const MovingVector<T>& a, const MovingVector<T>& b) {
  return sqrt(MovingVector<T>(a - b).squaredNorm());
}

/// How far the hip, shifted sideways, has to come down for the leg to be `reach` of its length.
template <class T>
TimeJet<T> missing(const Placed<T>& leg, const MovingVector<T>& shift, T reach) {
  const MovingVector<T> down = leg.limb.upper.translation + shift - leg.target.ankle;
  const TimeJet<T> longest = reach * leg.length, square = longest * longest;
  const T flattest = T(kFlattest) * leg.length.value;
  const TimeJet<T> high = square - down.x() * down.x() - down.y() * down.y();
  return down.z() - sqrt(soft_max<T>(high, {flattest * flattest}, flattest * flattest / 2));
}

/// What the legs need, or what is left of what they needed: follows them down at once, lets go with three
/// poles.
template <class T>
TimeJet<T> slow_to_rise(const TimeJet<T>& needed, const FootPlacementJob<T>& job, T above) {
  SmoothInput<T>& left = *job.drop;
  left.step(needed.value - above, SmoothInput<T>::pole_of(job.rise), job.step);
  const TimeJet<T> below = needed - TimeJet<T>(above);
  if (left.x < below) left.x = below;  // not seen where it happens: soft_max is `needed` up to here
  return soft_max<T>(needed, left.x, above);
}

template <class T>
MovingVector<T> pelvis_shift(std::span<const Placed<T>> legs, const FootPlacementJob<T>& job) {
  const TimeJet<T> none{T(0)};
  MovingVector<T> shift(none, none, none);
  for (const Placed<T>& leg : legs)
    shift += (leg.target.ankle - leg.motion.foot.translation) * (job.follow / T(legs.size()));
  shift.z() = none;
  TimeJet<T> drop = none;
  const T leg_length = legs.front().length.value, width = T(kWidth) * leg_length;
  for (const Placed<T>& leg : legs) drop = soft_max<T>(drop, missing<T>(leg, shift, job.reach), width);
  if (job.drop) drop = slow_to_rise(drop, job, T(kRising) * leg_length);
  shift.z() = -soft_min<T>(drop, {job.deepest}, width);
  return shift;
}

/// Shifts a joint in model space.
template <class T>
void shift_joint(const FootPlacementJob<T>& job, int joint, const MovingVector<T>& shift) {
  MovingTransform<T> local = moving_transform(job.jets[std::size_t(joint)]);
  const int parent = job.parents[std::size_t(joint)];
  if (parent < 0)
    local.translation += shift;
  else
    local.translation += model_motion<T>(job.jets, job.parents, parent).rotation.conjugate() * shift;
  JointJet<T>& jet = job.jets[std::size_t(joint)];
  jet.translation = value_of<T>(local.translation);
  jet.velocity = rate_of<T>(local.translation);
  jet.acceleration = acceleration_of<T>(local.translation);
}

template <class T>
LimbMotion<T> limb_motion(const FootPlacementJob<T>& job, std::size_t k) {
  const FootLeg<T>& leg = job.legs[k];
  return {job.jets, job.parents, leg.upper, leg.middle, leg.foot};
}

template <class T>
Placed<T> place(const FootPlacementJob<T>& job, std::size_t k) {
  const FootLeg<T>& leg = job.legs[k];
  Placed<T> placed;
  placed.limb = job.limbs.empty() ? limb_motion(job, k) : job.limbs[k];
  const MovingTransform<T>&upper = placed.limb.upper, &foot = placed.limb.end;
  placed.motion = FootMotion<T>(foot, leg.toe, leg.heel, job.level);
  placed.pole = upper.rotation * leg.bend;
  const MovingVector<T>& knee = placed.limb.middle.translation;
  placed.length = distance<T>(upper.translation, knee) + distance<T>(knee, foot.translation);
  FootState<T>& state = job.states[k];
  step_foot<T>(job.settings, job.step, state);
  find_ground<T>(placed.motion, job.settings, job.feet[k], job.grounds, state);
  placed.target = foot_target<T>(placed.motion, job.grounds, state);
  return placed;
}

template <class T>
Status reach_for(const FootPlacementJob<T>& job, std::size_t k, const Placed<T>& placed) {
  const FootLeg<T>& leg = job.legs[k];
  TwoBoneJob<T> bones{job.parents, job.jets, leg.upper, leg.middle, leg.foot};
  bones.target = placed.target.ankle;
  bones.pole = placed.pole;
  bones.hinge = leg.hinge;
  bones.softness = std::max(T(kSoftest), T(kLongest - kSpare) - job.reach);  // in float less at reach 0.998
  Status status = bones.Validate();
  if (status) status = bones.Run(placed.limb, &placed.target.rotation);
  return status ? status : Status::error(status.code, status.reason, static_cast<int>(k));
}

Status check_joints(std::span<const int> parents, std::size_t joints, int pelvis) {
  if (parents.size() < joints) return Status::error(Code::kInvalidArgument, "fewer parents than joints");
  if (pelvis < 0 || std::size_t(pelvis) >= joints)
    return Status::error(Code::kInvalidArgument, "no such pelvis");
  return {};
}

template <class T>
bool within(T x, T least, T most) {
  return x >= least && x <= most;
}

template <class T>
Status check_settings(const FootPlacementJob<T>& job) {
  const FootSettings<T>& s = job.settings;
  if (!within(s.release_at, T(0), s.lock_at) || !(s.lock_at <= T(1)))
    return Status::error(Code::kOutOfRange, "contact weights of locking and releasing are not in order");
  if (!(s.lock_time >= T(0)) || !(s.release_time >= T(0)) || !(s.half_life > T(0)) || !(s.farthest > T(0)) ||
      !within(s.steepest, T(0), T(1.5)))
    return Status::error(Code::kOutOfRange, "a time, length or angle of the settings is absurd");
  if (!within(job.reach, T(0.5), T(0.998)) || !within(job.follow, T(0), T(1)) || !(job.deepest >= T(0)) ||
      !(job.rise > T(0)))
    return Status::error(Code::kOutOfRange, "reach, follow, deepest or rise is out of range");
  if (!within(job.step, T(0), T(1e6))) return Status::error(Code::kOutOfRange, "step is negative or absurd");
  const TimeJet<T>& level = job.level;
  if (!std::isfinite(level.value + level.rate + level.acceleration))
    return Status::error(Code::kNotFinite, "level is not finite");
  return {};
}

template <class T>
Status check_hits(std::span<const GroundHit<T>> hits, int bodies, int leg) {
  for (const GroundHit<T>& hit : hits) {
    if (!hit.point.allFinite() || !(std::abs(hit.normal.norm() - T(1)) < T(1e-3)))
      return Status::error(Code::kNotFinite, "point of a hit is not finite, or its normal no unit vector",
                           leg);
    if (hit.ground < -1 || hit.ground >= bodies)
      return Status::error(Code::kInvalidArgument, "no such ground", leg);
  }
  return {};
}
template <class T>
Status check_input(const FootInput<T>& input, const FootState<T>& state, int bodies, int leg) {
  if (!within(input.contact, T(0), T(1)))
    return Status::error(Code::kOutOfRange, "contact is not within 0 and 1", leg);
  if (state.ground >= bodies)
    return Status::error(Code::kInvalidArgument, "the ground that the foot is on is not given", leg);
  if (Status status = check_hits(input.under, bodies, leg); !status) return status;
  return check_hits(input.ahead, bodies, leg);
}

}  // namespace

template <class T>
Status FootPlacementJob<T>::Validate() const {
  if (Status status = check_joints(parents, jets.size(), pelvis); !status) return status;
  if (Status status = check_settings(*this); !status) return status;
  if (legs.size() > kMostLegs || feet.size() < legs.size() || states.size() < legs.size())
    return Status::error(Code::kInvalidArgument, "more than eight legs, or fewer inputs or states than legs");
  if (!limbs.empty() && limbs.size() < legs.size())
    return Status::error(Code::kInvalidArgument, "fewer limbs than legs");
  for (std::size_t k = 0; k < legs.size(); ++k) {
    for (const int joint : {legs[k].upper, legs[k].middle, legs[k].foot})
      if (joint < 0 || std::size_t(joint) >= jets.size())
        return Status::error(Code::kInvalidArgument, "no such joint", static_cast<int>(k));
    if (!legs[k].toe.allFinite() || !legs[k].heel.allFinite() || !legs[k].bend.allFinite())
      return Status::error(Code::kNotFinite, "a point or direction is not finite", static_cast<int>(k));
    const Status status =
        check_input(feet[k], states[k], static_cast<int>(grounds.size()), static_cast<int>(k));
    if (!status) return status;
  }
  return {};
}

template <class T>
Status FootPlacementJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (legs.empty()) return {};
  Placed<T> placed[kMostLegs];
  for (std::size_t k = 0; k < legs.size(); ++k) placed[k] = place(*this, k);
  const MovingVector<T> shift = pelvis_shift<T>({placed, legs.size()}, *this);
  shift_joint<T>(*this, pelvis, shift);
  Status first;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    placed[k].limb.shift(shift);
    const Status status = reach_for<T>(*this, k, placed[k]);
    if (first.ok()) first = status;
    const T far = distance<T>(placed[k].limb.upper.translation, placed[k].target.ankle).value;
    const bool reached = far < T(kLongest) * placed[k].length.value;
    change_hold<T>(placed[k].motion, settings, feet[k].contact, reached, grounds, states[k]);
  }
  return first;
}

template struct FootPlacementJob<float>;
template struct FootPlacementJob<double>;

}  // namespace sinew
