#include "sinew/animation/foot_lock.h"

#include <cmath>
#include <limits>

#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/soft_limits.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kToeUp = 0.01,
                 kToeDown = 0.002;  ///< m, of the toe over the heel: the heel leads, and no longer
constexpr double kSole = 1e-3;      ///< m, within which the sole is lifted out of the ground softly
/// m, between the heights of heel and toe: less, and both are down. 3/16 of it is how far a sole that lies
/// flat is off the ground.
constexpr double kPivot = 4e-4;
constexpr double kFlat = 1e-3;  ///< m, between them: less on a foot that bears, and it lies flat

template <class T>
using Grounds = std::span<const MovingTransform<T>>;

template <class T>
Vec3<T> vector_of(const std::array<T, 3>& a) {
  return {a[0], a[1], a[2]};
}
template <class T>
std::array<T, 3> array_of(const Vec3<T>& v) {
  return {v.x(), v.y(), v.z()};
}

template <class T>
bool is_zero(const TimeJet<T>& x) {
  return x.value == T(0) && x.rate == T(0) && x.acceleration == T(0);
}

/// A point and a direction that are fixed to a ground, in model space.
template <class T>
MovingVector<T> point_of(int ground, Grounds<T> grounds, const std::array<T, 3>& point) {
  const Vec3<T> p = vector_of(point);
  return ground < 0 ? still<T>(p) : grounds[std::size_t(ground)] * p;
}
template <class T>
MovingVector<T> direction_of(int ground, Grounds<T> grounds, const std::array<T, 3>& direction) {
  const Vec3<T> d = vector_of(direction);
  return ground < 0 ? still<T>(d) : grounds[std::size_t(ground)].rotation * d;
}

/// A plane as a height over x and y, in model space, as it moves.
template <class T>
struct MovingPlane {
  MovingVector<T> point;
  TimeJet<T> slope[2];

  TimeJet<T> height(const TimeJet<T>& x, const TimeJet<T>& y) const {
    return point.z() + slope[0] * (x - point.x()) + slope[1] * (y - point.y());
  }
};
template <class T>
MovingPlane<T> plane_of(const FootState<T>& state, Grounds<T> grounds) {
  const MovingVector<T> normal = direction_of<T>(state.ground, grounds, state.normal);
  return {point_of<T>(state.ground, grounds, state.point),
          {-(normal.x() / normal.z()), -(normal.y() / normal.z())}};
}

template <class T>
bool is_wall(const GroundHit<T>& hit, T steepest) {
  return !(hit.normal.z() > portable::cos(steepest));
}
template <class T>
T height_at(const GroundHit<T>& hit, T steepest, T x, T y) {
  if (is_wall(hit, steepest)) return hit.point.z();
  const T fall = hit.normal.x() * (x - hit.point.x()) + hit.normal.y() * (y - hit.point.y());
  return hit.point.z() - fall / hit.normal.z();
}

/// A point of the model in the axes of a ground.
template <class T>
std::array<T, 3> on_ground(int ground, Grounds<T> grounds, const Vec3<T>& point) {
  if (ground < 0) return array_of(point);
  const MovingTransform<T>& body = grounds[std::size_t(ground)];
  return array_of<T>(body.rotation.value.conjugate() * Vec3<T>(point - value_of<T>(body.translation)));
}

template <class T>
void lay_plane(const GroundHit<T>& hit, T steepest, Grounds<T> grounds, FootState<T>& state) {
  const Vec3<T> normal = is_wall(hit, steepest) ? Vec3<T>(Vec3<T>::UnitZ()) : hit.normal;
  state.ground = hit.ground;
  state.point = on_ground<T>(hit.ground, grounds, hit.point);
  state.normal = hit.ground < 0
                     ? array_of(normal)
                     : array_of<T>(grounds[std::size_t(hit.ground)].rotation.value.conjugate() * normal);
}

/// What of a foot's target does not depend on where it goes.
template <class T>
struct Stance {
  QuinticOffset<T> fade;  ///< of what was when the hold changed
  TimeJet<T> grip;        ///< 0 = as animated … 1 = on the ground
  MovingPlane<T> plane;
  TimeJet<T> upright;               ///< z of the normal that the foot lies to
  MovingRotation<T> rotation;       ///< of the foot, wanted
  TimeJet<T> toe, heel;             ///< m, height over the animation's ground
  MovingVector<T> to_toe, to_heel;  ///< from the ankle, wanted
};
/// x, but for what lies within twice kFlat of 0, softly.
template <class T>
TimeJet<T> without_tremble(const TimeJet<T>& x) {
  const TimeJet<T> flat{T(kFlat)};
  return soft_positive<T>(x - flat, T(kFlat)) - soft_positive<T>(-x - flat, T(kFlat));
}
template <class T>
Stance<T> stance_of(const FootMotion<T>& motion, Grounds<T> grounds, const FootState<T>& state) {
  Stance<T> s;
  s.fade = QuinticOffset<T>::at(state.elapsed, state.duration);
  s.plane = plane_of<T>(state, grounds);
  const TimeJet<T> one{T(1)};
  const MovingVector<T> normal(-(s.plane.slope[0] + state.slope[0].x), -(s.plane.slope[1] + state.slope[1].x),
                               one);
  s.upright = one / sqrt(normal.squaredNorm());
  s.rotation = motion.foot.rotation;
  s.toe = motion.toe_at.z() - motion.level;
  s.heel = motion.heel_at.z() - motion.level;
  s.grip = TimeJet<T>(state.locked() ? T(1) : T(0)) + s.fade(state.grip);
  const TimeJet<T> raised = s.heel - s.toe, flat = without_tremble(raised) - raised;
  if (motion.toe != motion.heel && !is_zero(s.grip)) {
    const MovingVector<T> sole = motion.toe_at - motion.heel_at;
    MovingVector<T> turned = sole;
    turned.z() -= s.grip * flat;
    s.rotation = shortest_arc<T>(sole, turned) * s.rotation;
    s.heel += s.grip * flat;
  }
  s.rotation = shortest_arc<T>(still<T>(Vec3<T>::UnitZ()), normal) * s.rotation;
  s.to_toe = s.rotation * motion.toe;
  s.to_heel = s.rotation * motion.heel;
  return s;
}

/// Height over the ground of the point that leads. Of the animation's, `grip` takes what the lowest point of
/// the sole has, so that one of its ends rests; what is below the ground is lifted out of it. No term changes
/// when the other end takes the lead.
template <class T>
TimeJet<T> clearance(const Stance<T>& s, FootHold hold) {
  const TimeJet<T> lowest = soft_min<T>(s.toe, s.heel, T(kPivot));
  const TimeJet<T> left = (TimeJet<T>(T(1)) - s.grip) * (lowest + soft_positive<T>(-lowest, T(kSole)));
  return ((hold == FootHold::kHeel ? s.heel : s.toe) - lowest + left) / s.upright;
}

template <class T>
MovingVector<T> to_pivot(const Stance<T>& s, FootHold hold) {
  return hold == FootHold::kHeel ? s.to_heel : s.to_toe;
}

/// Where toe or heel goes if nothing of the past is left but what `fading` says.
template <class T>
MovingVector<T> pivot_target(const Stance<T>& s, const FootMotion<T>& motion, Grounds<T> grounds,
                             const FootState<T>& state, const MovingVector<T>& fading) {
  MovingVector<T> p = motion.toe_at;
  if (state.locked()) p = point_of<T>(state.ground, grounds, state.lock);
  p.x() += fading.x();
  p.y() += fading.y();
  p.z() = s.plane.height(p.x(), p.y()) + state.height.x + fading.z() + clearance(s, state.hold);
  return p;
}

template <class T>
MovingVector<T> present_pivot(const Stance<T>& s, const FootMotion<T>& motion, Grounds<T> grounds,
                              const FootState<T>& state) {
  const MovingVector<T> fading(s.fade(state.offset[0]), s.fade(state.offset[1]), s.fade(state.offset[2]));
  return pivot_target<T>(s, motion, grounds, state, fading);
}

template <class T>
T apart_on_ground(const MovingVector<T>& a, const MovingVector<T>& b) {
  return portable::hypot(a.x().value - b.x().value, a.y().value - b.y().value);
}

template <class T>
FootHold wanted_hold(const FootMotion<T>& motion, const FootSettings<T>& settings, T contact, bool reached,
                     Grounds<T> grounds, const FootState<T>& state) {
  if (state.locked()) {
    const MovingVector<T> lock = point_of<T>(state.ground, grounds, state.lock);
    const MovingVector<T>& animated = state.hold == FootHold::kHeel ? motion.heel_at : motion.toe_at;
    if (contact < settings.release_at || !reached || apart_on_ground<T>(lock, animated) > settings.farthest)
      return FootHold::kFree;
  } else if (contact < settings.lock_at || !reached || state.elapsed < state.duration) {
    return FootHold::kFree;
  }
  // The heel only while the toe is well above it: who stands on the whole sole turns about the ball.
  const T raised = motion.toe_at.z().value - motion.heel_at.z().value;
  return raised > T(state.hold == FootHold::kHeel ? kToeDown : kToeUp) ? FootHold::kHeel : FootHold::kToe;
}

}  // namespace

template <class T>
void step_foot(const FootSettings<T>& settings, T h, FootState<T>& state) {
  const T pole = SmoothInput<T>::pole_of(settings.half_life);
  state.height.step(T(0), pole, h);
  for (SmoothInput<T>& slope : state.slope) slope.step(T(0), pole, h);
  state.elapsed += h;
}

template <class T>
void find_ground(const FootMotion<T>& motion, const FootSettings<T>& settings, const FootInput<T>& input,
                 std::span<const MovingTransform<T>> grounds, FootState<T>& state) {
  if (state.locked()) return;
  const bool appears = !state.started;
  state.started = true;
  if (appears) {
    const GroundHit<T> level{{T(0), T(0), motion.level.value}};
    lay_plane<T>(input.under.empty() ? level : input.under[0], settings.steepest, grounds, state);
  }
  const QuinticOffset<T> fade = QuinticOffset<T>::at(state.elapsed, state.duration);
  const TimeJet<T> x = motion.toe_at.x() + fade(state.offset[0]),
                   y = motion.toe_at.y() + fade(state.offset[1]);
  const GroundHit<T>* highest = nullptr;
  T height = -std::numeric_limits<T>::infinity();
  const auto look_at = [&](std::span<const GroundHit<T>> hits) {
    for (const GroundHit<T>& hit : hits) {
      const T under_foot = height_at(hit, settings.steepest, x.value, y.value);
      if (!(under_foot > height)) continue;
      height = under_foot;
      highest = &hit;
    }
  };
  look_at(input.under);
  if (input.contact < settings.lock_at) look_at(input.ahead);
  if (!highest) return;
  const MovingPlane<T> before = plane_of<T>(state, grounds);
  lay_plane<T>(*highest, settings.steepest, grounds, state);
  if (appears) return;
  const MovingPlane<T> plane = plane_of<T>(state, grounds);
  state.height.x += before.height(x, y) - plane.height(x, y);
  for (int k = 0; k < 2; ++k) state.slope[k].x += before.slope[k] - plane.slope[k];
}

template <class T>
FootTarget<T> foot_target(const FootMotion<T>& motion, std::span<const MovingTransform<T>> grounds,
                          const FootState<T>& state) {
  const Stance<T> s = stance_of<T>(motion, grounds, state);
  return {present_pivot<T>(s, motion, grounds, state) - to_pivot(s, state.hold), s.rotation};
}

template <class T>
void change_hold(const FootMotion<T>& motion, const FootSettings<T>& settings, T contact, bool reached,
                 std::span<const MovingTransform<T>> grounds, FootState<T>& state) {
  const FootHold before = state.hold,
                 after = wanted_hold<T>(motion, settings, contact, reached, grounds, state);
  if (before == after) return;
  const Stance<T> s = stance_of<T>(motion, grounds, state);
  // Where the point that leads from now on is at this instant.
  const MovingVector<T> now =
      present_pivot<T>(s, motion, grounds, state) - to_pivot(s, before) + to_pivot(s, after);
  state.hold = after;
  if (state.locked()) {
    const Vec3<T> lock(now.x().value, now.y().value, s.plane.height(now.x(), now.y()).value);
    state.lock = on_ground<T>(state.ground, grounds, lock);
    state.height = {};
  }
  state.grip = s.grip - TimeJet<T>(state.locked() ? T(1) : T(0));
  const TimeJet<T> none{T(0)};
  MovingVector<T> left = now - pivot_target<T>(s, motion, grounds, state, {none, none, none});
  left.z() = none;
  left.z() = (now - pivot_target<T>(s, motion, grounds, state, left)).z();
  for (int k = 0; k < 3; ++k) state.offset[k] = left[k];
  state.elapsed = 0;
  state.duration = state.locked() ? settings.lock_time : settings.release_time;
}

SINEW_FOOT_LOCK_INSTANCES(, float)
SINEW_FOOT_LOCK_INSTANCES(, double)

}  // namespace sinew
