#include "sinew/animation/inverse_kinematics.h"

#include <cmath>

#include "sinew/animation/soft_limits.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kLongest =
    0.9995;  ///< of the limb's length: the knee keeps 3.6° of bend, and a finite velocity

template <class T>
bool finite(const MovingVector<T>& v) {
  return value_of<T>(v).allFinite() && rate_of<T>(v).allFinite() && acceleration_of<T>(v).allFinite();
}
template <class T>
Status check_weight(const TimeJet<T>& w) {
  if (!std::isfinite(w.value) || !std::isfinite(w.rate) || !std::isfinite(w.acceleration))
    return Status::error(Code::kNotFinite, "weight is not finite");
  if (w.value < T(0) || w.value > T(1))
    return Status::error(Code::kOutOfRange, "weight is not within 0 and 1");
  return {};
}
template <class T>
bool is_zero(const TimeJet<T>& w) {
  return w.value == T(0) && w.rate == T(0) && w.acceleration == T(0);
}
bool is_below(std::span<const int> parents, int joint, int ancestor) {
  while (joint > ancestor) joint = parents[joint];
  return joint == ancestor;
}

template <class T>
TimeJet<T> length(const MovingVector<T>& v) {
  return sqrt(v.squaredNorm());
}
template <class T>
MovingVector<T> part_normal_to(const MovingVector<T>& unit, const MovingVector<T>& v) {
  return v - unit * unit.dot(v);
}

/// Turns a joint, whose model rotation `was` so with its parents as they are by now, to what it `becomes`.
template <class T>
void turn_joint(const MovingRotation<T>& was, const MovingRotation<T>& becomes, JointJet<T>& jet) {
  set_rotation<T>(moving_rotation(jet) * (was.conjugate() * becomes), jet);
}

}  // namespace

template <class T>
Status TwoBoneJob<T>::Validate() const {
  if (jets.size() > parents.size()) return Status::error(Code::kInvalidArgument, "fewer parents than joints");
  for (const int joint : {upper, middle, end})
    if (joint < 0 || joint >= int(jets.size()))
      return Status::error(Code::kInvalidArgument, "no such joint", joint);
  if (middle <= upper || end <= middle || !is_below(parents, middle, upper) ||
      !is_below(parents, end, middle))
    return Status::error(Code::kInvalidArgument, "upper, middle and end are not one below the other", end);
  if (!finite<T>(target) || !finite<T>(pole) || !hinge.allFinite())
    return Status::error(Code::kNotFinite, "target, pole or hinge is not finite");
  if (!(softness >= T(0.001) && softness < T(1)))
    return Status::error(Code::kOutOfRange, "softness is not within 0.001 and 1");
  return check_weight(weight);
}

template <class T>
Status TwoBoneJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (is_zero(weight)) return {};
  const LimbMotion<T> limb(jets, parents, upper, middle, end);
  return Run(limb, keep_end ? &limb.end.rotation : nullptr);
}

template <class T>
Status TwoBoneJob<T>::Run(const LimbMotion<T>& limb, const MovingRotation<T>* end_rotation) const {
  const MovingTransform<T>&a = limb.upper, &b = limb.middle, &c = limb.end;
  const MovingVector<T> first = b.translation - a.translation, second = c.translation - b.translation;
  const TimeJet<T> l1 = length<T>(first), l2 = length<T>(second);
  const MovingVector<T> wanted = c.translation + (target - c.translation) * weight - a.translation;
  const TimeJet<T> far = length<T>(wanted), shortest = l1 > l2 ? l1 - l2 : l2 - l1;
  if (!(l1.value > T(0)) || !(l2.value > T(0)) || !(far.value > T(1e-6) * l1.value))
    return Status::error(Code::kOutOfRange, "target at the upper joint, or a bone without length", upper);

  TimeJet<T> reach = (l1 + l2) * soft_min<T>(far / (l1 + l2), {T(kLongest)}, softness);
  const TimeJet<T> folded = shortest + T(1 - kLongest) * l1;
  if (reach < folded) reach = folded;
  const MovingVector<T> along = wanted / far;
  MovingVector<T> side = part_normal_to<T>(along, value_of<T>(pole).isZero() ? first : pole);
  const TimeJet<T> sideways = length<T>(side);
  if (!(sideways.value > T(1e-6) * l1.value))
    return Status::error(Code::kOutOfRange,
                         "limb is straight, or its pole lies along it: no plane to bend in", middle);
  side /= sideways;
  const TimeJet<T> x = (reach * reach + l1 * l1 - l2 * l2) / (reach + reach), y = sqrt(l1 * l1 - x * x);
  const MovingVector<T> knee = along * x + side * y, shin = along * reach - knee;

  MovingRotation<T> swing = shortest_arc<T>(first, knee);
  if (!hinge.isZero()) {
    const MovingVector<T> unit = knee / l1, normal = along.cross(side);
    const MovingVector<T> axis = part_normal_to<T>(unit, swing * (b.rotation * hinge));
    swing = shortest_arc<T>(axis, axis.dot(normal).value < T(0) ? MovingVector<T>(-normal) : normal) * swing;
  }
  const MovingRotation<T> bend = shortest_arc<T>(swing * second, shin);
  const MovingRotation<T> shin_was = swing * b.rotation;
  turn_joint<T>(a.rotation, swing * a.rotation, jets[upper]);
  turn_joint<T>(shin_was, bend * shin_was, jets[middle]);
  if (end_rotation) turn_joint<T>(bend * (swing * c.rotation), *end_rotation, jets[end]);
  return {};
}

template <class T>
Status AimJob<T>::Validate() const {
  if (jets.size() > parents.size()) return Status::error(Code::kInvalidArgument, "fewer parents than joints");
  if (joint < 0 || joint >= int(jets.size()))
    return Status::error(Code::kInvalidArgument, "no such joint", joint);
  if (!finite<T>(target)) return Status::error(Code::kNotFinite, "target is not finite");
  if (!(std::abs(axis.norm() - T(1)) < T(1e-3)))
    return Status::error(Code::kInvalidArgument, "axis is not a unit vector");
  if (!(limit >= T(0) && limit <= T(3.1)))
    return Status::error(Code::kOutOfRange, "limit is not within 0 and 3.1");
  return check_weight(weight);
}

template <class T>
Status AimJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (is_zero(weight)) return {};
  const std::span<const JointJet<T>> before = jets;
  const MovingTransform<T> frame = model_motion(before, parents, joint);
  const MovingVector<T> wanted = target - frame.translation, now = frame.rotation * axis;
  const TimeJet<T> far = length<T>(wanted);
  // Opposite directions leave the way round open: too far to choose.
  if (!(far.value > T(0)) || value_of<T>(now).dot(value_of<T>(wanted)) < T(-0.99999) * far.value)
    return Status::error(Code::kOutOfRange, "target at the joint, or straight behind it", joint);
  Quat<TimeJet<T>> turn = moving_quaternion(shortest_arc<T>(now, wanted));
  const T widest = portable::cos(limit / 2);
  if (turn.w().value < widest) {
    const TimeJet<T> sine = length<T>(turn.vec());
    turn.vec() = turn.vec() * (std::sqrt(1 - widest * widest) / sine);
    turn.w() = widest;
  }
  for (int i = 0; i < 4; ++i) turn.coeffs()[i] *= weight;
  turn.w() += TimeJet<T>(T(1)) - weight;
  turn_joint<T>(frame.rotation, moving_rotation(turn) * frame.rotation, jets[joint]);
  return {};
}

template struct TwoBoneJob<float>;
template struct TwoBoneJob<double>;
template struct AimJob<float>;
template struct AimJob<double>;

}  // namespace sinew
