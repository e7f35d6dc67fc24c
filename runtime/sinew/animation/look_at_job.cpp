#include "sinew/animation/look_at_job.h"

#include <cmath>

#include "sinew/animation/jet_angles.h"
#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/soft_limits.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNoYaw = 0.17, kAllYaw = 0.5;  ///< cosines of the pitch at which yaw means nothing, and all
constexpr double kStraightUp = 0.02;            ///< cosine of a pitch that is beyond any limit
constexpr double kNearest = 1e-4;               ///< m, of a target
constexpr double kQuinticPeak = 1.875;          ///< largest rate of a quintic from rest, over its mean

template <class T>
struct Angles {
  TimeJet<T> yaw, pitch;  ///< rad; left, up

  Angles operator+(const Angles& b) const { return {yaw + b.yaw, pitch + b.pitch}; }
  Angles operator-(const Angles& b) const { return {yaw - b.yaw, pitch - b.pitch}; }
};

/// Where a target is.
template <class T>
struct Seen {
  Angles<T> angles;
  TimeJet<T> part;  ///< of the yaw that counts
};

/// Axes in which angles are measured, in model space.
template <class T>
struct Axes {
  MovingVector<T> forward, left, up;
};

template <class T>
Seen<T> see(const Axes<T>& axes, const MovingVector<T>& way) {
  const TimeJet<T> x = way.dot(axes.forward), y = way.dot(axes.left), z = way.dot(axes.up);
  const TimeJet<T> level = x * x + y * y, square = level + z * z, none{T(0)};
  if (!(level.value > T(kStraightUp * kStraightUp) * square.value))
    return {{none, TimeJet<T>(z.value < T(0) ? T(-kPi / 2) : T(kPi / 2))}, none};
  const Angles<T> angles{angle_of(x, y), angle_of(sqrt(level), z)};
  const TimeJet<T> flat = sqrt(level / square);
  if (flat.value >= T(kAllYaw)) return {angles, {T(1)}};
  if (flat.value <= T(kNoYaw)) return {angles, none};
  const TimeJet<T> u = T(1 / (kAllYaw - kNoYaw)) * (flat - TimeJet<T>(T(kNoYaw)));
  return {angles, u * u * u * (TimeJet<T>(T(10)) - T(15) * u + T(6) * (u * u))};
}

/// Yaw of a target behind, beyond half a turn where it is looked for on the other side.
template <class T>
T full_turns(const TimeJet<T>& yaw, int side) {
  return T(side) * yaw.value < T(-kPi / 2) ? T(2 * kPi * side) : T(0);
}

template <class T>
Angles<T> limited(const Seen<T>& seen, int side, const LookSettings<T>& s) {
  const Angles<T>& a = seen.angles;
  const TimeJet<T> yaw = seen.part * (a.yaw + TimeJet<T>(full_turns(a.yaw, side)));
  const auto between = [&](const TimeJet<T>& x, T low, T high) {
    return soft_max<T>(soft_min<T>(x, {high}, s.softness), {low}, s.softness);
  };
  return {between(yaw, -s.yaw, s.yaw), between(a.pitch, -s.pitch_down, s.pitch_up)};
}

/// The side for a target from now on.
template <class T>
int side_of(const TimeJet<T>& yaw, int side, T behind) {
  if (!(T(side) * yaw.value < T(0))) return side;
  const T turns = full_turns(yaw, side);
  return turns != T(0) && std::abs(yaw.value + turns) <= T(kPi) + behind ? side : -side;
}

/// One run of a look: what it shows, and what it shall show from now on.
template <class T>
struct Turn {
  const LookAtJob<T>& job;
  Axes<T> axes;
  QuinticOffset<T> fade;
  int side;               ///< until now
  bool appears, changes;  ///< in this run
  T farthest = 0;         ///< rad, that a look has to turn by the change

  /// Angles that are looked at, from a place.
  Angles<T> look(const MovingVector<T>& from, typename LookState<T>::Track& track);
};

template <class T>
Angles<T> Turn<T>::look(const MovingVector<T>& from, typename LookState<T>::Track& track) {
  const LookSettings<T>& s = job.settings;
  const Angles<T> goal = limited(see<T>(axes, job.target - from), job.state->side, s);
  if (s.half_life > T(0)) {
    const T pole = SmoothInput<T>::pole_of(s.half_life), values[] = {goal.yaw.value, goal.pitch.value};
    for (int k = 0; k < 2; ++k) {
      if (appears) track.angles[k].x = TimeJet<T>(values[k]);
      track.angles[k].step(values[k], pole, job.step);
    }
    return {track.angles[0].x, track.angles[1].x};
  }
  const Angles<T> left{fade(track.offset[0]), fade(track.offset[1])};
  if (!changes) return goal + left;
  const MovingVector<T>& old = job.before ? *job.before : job.target;
  const Angles<T> shown = limited(see<T>(axes, old - from), side, s) + left, offset = shown - goal;
  track.offset[0] = offset.yaw;
  track.offset[1] = offset.pitch;
  farthest = largest(farthest, portable::hypot(offset.yaw.value, offset.pitch.value));
  return shown;
}

/// Moves the state on to this instant, and chooses the side.
template <class T>
Turn<T> begin_turn(const LookAtJob<T>& job, const Axes<T>& axes, const MovingVector<T>& eyes) {
  LookState<T>& state = *job.state;
  const TimeJet<T> yaw = see<T>(axes, job.target - eyes).angles.yaw;
  const int own_side = yaw.value < T(0) ? -1 : 1;
  const bool appears = !state.started;
  state.started = true;
  state.elapsed += job.step;
  if (appears) state.side = own_side;
  const int side = state.side;
  state.side = job.before ? own_side : side_of(yaw, side, job.settings.behind);
  const bool from_behind = state.side != side && full_turns(yaw, side) != T(0);
  return {job,  axes,    QuinticOffset<T>::at(state.elapsed, state.duration),
          side, appears, !appears && (job.before || from_behind)};
}
template <class T>
void end_turn(const Turn<T>& turn, const LookSettings<T>& settings, LookState<T>& state) {
  if (!turn.changes) return;
  state.elapsed = 0;
  state.duration = largest(settings.least_time, T(kQuinticPeak) * turn.farthest / settings.fastest);
}

template <class T>
MovingVector<T> direction(const Axes<T>& axes, const Angles<T>& a) {
  const TimeJet<T> level = cosine(a.pitch);
  return axes.forward * (level * cosine(a.yaw)) + axes.left * (level * sine(a.yaw)) + axes.up * sine(a.pitch);
}

template <class T>
Axes<T> axes_of(const LookAtJob<T>& job) {
  const LookChain<T>& c = *job.chain;
  const MovingTransform<T> base =
      c.base < 0 ? MovingTransform<T>() : model_motion<T>(job.jets, job.parents, c.base);
  return {base.rotation * c.forward, base.rotation * Vec3<T>(c.up.cross(c.forward)), base.rotation * c.up};
}

/// The chain in model space, and how far it has been turned so far.
template <class T>
struct Chain {
  MovingTransform<T> frames[LookChain<T>::kMost];  ///< as animated
  MovingVector<T> gaze;                            ///< where the last one looks, as animated
  MovingVector<T> place;                           ///< m, of the next joint, where those before carry it
  MovingRotation<T> turned;
};
template <class T>
Chain<T> chain_of(const LookAtJob<T>& job) {
  const std::span<const JointJet<T>> jets = job.jets;
  const LookChain<T>& c = *job.chain;
  Chain<T> chain;
  chain.frames[0] = model_motion<T>(jets, job.parents, c.joints[0]);
  for (int k = 1; k < c.count; ++k)
    chain.frames[k] = chain.frames[k - 1] * model_motion<T>(jets, job.parents, c.joints[k], c.joints[k - 1]);
  chain.gaze = chain.frames[c.count - 1].rotation * c.axis;
  chain.place = chain.frames[0].translation;
  return chain;
}

/// Turns joint k of the chain by `part` of what the look lacks to a direction.
template <class T>
Status turn_joint(const LookAtJob<T>& job, int k, const MovingVector<T>& wanted, const TimeJet<T>& part,
                  Chain<T>& chain) {
  const LookChain<T>& c = *job.chain;
  const MovingVector<T> now = chain.turned * chain.gaze;
  if (value_of<T>(now).dot(value_of<T>(wanted)) < T(-0.9999))
    return Status::error(Code::kOutOfRange, "looks the opposite way", c.joints[k]);
  const MovingRotation<T> turn = shortest_arc<T>(now, wanted, part);
  JointJet<T>& jet = job.jets[std::size_t(c.joints[k])];
  const MovingRotation<T> was = chain.turned * chain.frames[k].rotation;
  set_rotation<T>(moving_rotation(jet) * (was.conjugate() * (turn * was)), jet);
  chain.turned = turn * chain.turned;
  if (k + 1 < c.count)
    chain.place += chain.turned * (chain.frames[k + 1].translation - chain.frames[k].translation);
  return {};
}

/// Turns all joints but the last, then the last one, which is where it stays by then.
template <class T>
Status turn_chain(Turn<T>& turn, Chain<T>& chain) {
  const LookAtJob<T>& job = turn.job;
  const LookChain<T>& c = *job.chain;
  const int last = c.count - 1;
  const MovingVector<T> body =
      direction(turn.axes, turn.look(chain.frames[last].translation, job.state->body));
  TimeJet<T> left{T(1)};
  for (int k = 0; k < last; ++k) {
    const TimeJet<T> share = c.shares[k] * job.weight;
    if (Status status = turn_joint<T>(job, k, body, share / left, chain); !status) return status;
    left -= share;
  }
  const MovingVector<T> head = direction(turn.axes, turn.look(chain.place, job.state->head));
  const TimeJet<T> share = c.shares[last] * job.weight;
  return turn_joint<T>(job, last, head, share / (share + TimeJet<T>(T(1)) - job.weight), chain);
}

template <class T>
bool finite(const TimeJet<T>& x) {
  return std::isfinite(x.value) && std::isfinite(x.rate) && std::isfinite(x.acceleration);
}
template <class T>
bool finite(const MovingVector<T>& v) {
  return finite(v.x()) && finite(v.y()) && finite(v.z());
}

template <class T>
Status check_chain(const LookChain<T>& c, std::span<const int> parents, std::size_t joints) {
  if (c.count < 1 || c.count > LookChain<T>::kMost)
    return Status::error(Code::kInvalidArgument, "no joints in the chain, or too many");
  if (c.base >= int(joints)) return Status::error(Code::kInvalidArgument, "no such base", c.base);
  T sum = 0;
  for (int k = 0; k < c.count; ++k) {
    int above = c.joints[k];
    if (above < 0 || above >= int(joints))
      return Status::error(Code::kInvalidArgument, "no such joint", above);
    const int wanted = k > 0 ? c.joints[k - 1] : c.base;
    while (above > wanted) above = parents[std::size_t(above)];
    if (above != wanted || c.joints[k] == wanted)
      return Status::error(Code::kInvalidArgument, "joints are not one below the other", c.joints[k]);
    if (!(c.shares[k] > T(0))) return Status::error(Code::kOutOfRange, "share is not above 0", c.joints[k]);
    sum += c.shares[k];
  }
  if (!(std::abs(sum - T(1)) < T(1e-3))) return Status::error(Code::kOutOfRange, "shares do not add up to 1");
  const auto unit = [](const Vec3<T>& v) { return std::abs(v.norm() - T(1)) < T(1e-3); };
  if (!unit(c.forward) || !unit(c.up) || !unit(c.axis) || !(std::abs(c.forward.dot(c.up)) < T(1e-3)))
    return Status::error(Code::kInvalidArgument, "an axis is no unit vector, or up leans forward");
  return {};
}

template <class T>
Status check_settings(const LookSettings<T>& s) {
  if (!(s.softness > T(0)) || !(s.yaw >= s.softness && s.yaw < T(3.1)))
    return Status::error(Code::kOutOfRange, "yaw is not within softness and 3.1");
  if (!(s.pitch_up >= s.softness && s.pitch_down >= s.softness) ||
      !(s.pitch_up + s.softness <= T(1.5) && s.pitch_down + s.softness <= T(1.5)))
    return Status::error(Code::kOutOfRange, "pitch is not within softness and 1.5 with it");
  if (!(s.behind >= T(0) && s.behind <= T(1.5)) || !(s.fastest > T(0)) || !(s.least_time >= T(0)) ||
      !(s.half_life >= T(0)))
    return Status::error(Code::kOutOfRange, "behind, fastest or a time is absurd");
  return {};
}

}  // namespace

template <class T>
Status LookAtJob<T>::Validate() const {
  if (!chain || !state) return Status::error(Code::kInvalidArgument, "no chain or no state");
  if (jets.size() > parents.size()) return Status::error(Code::kInvalidArgument, "fewer parents than joints");
  if (Status status = check_chain(*chain, parents, jets.size()); !status) return status;
  if (Status status = check_settings(settings); !status) return status;
  if (!finite<T>(target) || (before && !finite<T>(*before)) || !finite(weight))
    return Status::error(Code::kNotFinite, "target or weight is not finite");
  if (!(weight.value >= T(0) && weight.value <= T(1)) || !(step >= T(0) && step <= T(1e6)))
    return Status::error(Code::kOutOfRange, "weight is not within 0 and 1, or step is absurd");
  return {};
}

template <class T>
Status LookAtJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  const Axes<T> axes = axes_of(*this);
  Chain<T> links = chain_of(*this);
  const MovingVector<T>& eyes = links.frames[chain->count - 1].translation;
  for (const MovingVector<T>* to : {&target, before})
    if (to && !(value_of<T>(MovingVector<T>(*to - eyes)).norm() > T(kNearest)))
      return Status::error(Code::kOutOfRange, "target at the joint that looks",
                           chain->joints[chain->count - 1]);
  Turn<T> turn = begin_turn<T>(*this, axes, eyes);
  const Status status = turn_chain<T>(turn, links);
  end_turn(turn, settings, *state);
  return status;
}

template struct LookAtJob<float>;
template struct LookAtJob<double>;

}  // namespace sinew
