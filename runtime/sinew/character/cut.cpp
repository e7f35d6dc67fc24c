#include "sinew/character/cut.h"

#include <algorithm>

namespace sinew {
namespace {

/// rad and m of a human: an animation that is so far from where its velocities lead in one step was cut.
constexpr double kCut = 0.2;

/// How far a motion in one step is from the one that goes on at the velocity before it, at the velocity after
/// it, or at one in between: an animation that stops at once, or starts, is not cut.
template <class T>
T off_its_way(const Vec3<T>& moved, const Vec3<T>& leaving, const Vec3<T>& arriving) {
  const Vec3<T> change = arriving - leaving, off = moved - leaving;
  const T size = change.squaredNorm();
  const T share = size > T(0) ? std::clamp(change.dot(off) / size, T(0), T(1)) : T(0);
  return (off - share * change).norm();
}

template <class T>
bool leaps(const JointJet<T>& now, const JointJet<T>& last, T h, T unit) {
  const Vec3<T> turned = rotation_log<T>(last.rotation.conjugate() * now.rotation);
  return off_its_way<T>(now.translation - last.translation, h * last.velocity, h * now.velocity) >=
             T(kCut) * unit ||
         off_its_way<T>(turned, h * last.omega, h * now.omega) >= T(kCut);
}

template <class T>
void turn(const Mat3<T>& by, History<T>& history) {
  for (auto* vectors :
       {&history.center, &history.velocity, &history.momentum, &history.acceleration, &history.torque})
    for (Vec3<T>& v : *vectors) v = (by * v).eval();
  for (auto* matrices : {&history.rotation, &history.rotation_rate})
    for (Mat3<T>& m : *matrices) m = (by * m).eval();
  history.other.clear();
}

}  // namespace

template <class T>
bool carry_over(CharacterState<T>& s, T h, Leap& leap) {
  if (!s.root_is_kinematic() || !s.floats) return false;
  if (!leaps(s.target[0], s.last_target()[0], h, s.tree.scale.length)) return false;
  const Transform<T> before = a_step_ago(s.target[0], h);
  s.keep_record();
  const Quat<T> turned = before.rotation * s.local[0].rotation.conjugate();
  leap = {turned.template cast<double>().normalized(), s.history.place,
          before.translation.template cast<double>()};
  turn<T>(turned.toRotationMatrix(), s.history);
  s.history.place = before.translation.template cast<double>();
  s.local[0] = before;
  restart(before, s.target[0], s.own_last_target()[0]);
  s.pose_changed();
  s.forget_energy();
  return true;
}

template <class T>
void go_along(CharacterState<T>& s, const Leap& leap) {
  s.keep_record();
  const Quat<T> turned = leap.turn.template cast<T>();
  if (s.floats) {
    turn<T>(turned.toRotationMatrix(), s.history);
    s.history.place = leap.of(s.history.place);
    s.local[0] = {(turned * s.local[0].rotation).normalized(), s.history.place.template cast<T>()};
    s.pose_changed();
  } else {  // points about a place that stays
    const Vec3<T> about = s.local[0].translation;
    for (int i = 1; i < s.tree.bodies; ++i) {
      const Vec3<double> place = (about + s.local[i].translation).template cast<double>();
      s.target[i].translation = leap.of(place).template cast<T>() - about;
      s.target[i].velocity = turned * s.history.velocity[i];
    }
    s.reset_to_target(Vec3<T>::Zero());
  }
  s.forget_energy();
  s.levels.wake = true;
}

template <class T>
void meet_cuts(CharacterState<T>& s, T h) {
  if (s.target_stands) return;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const JointJet<T>& now = s.target[i];
    if (!leaps(now, s.last_target()[i], h, s.tree.scale.length)) continue;
    const Transform<T> before = a_step_ago(now, h);
    restart(before, now, s.own_last_target()[i]);
    Deviation<T>& d = s.deviation[i];
    if (d.on_animation) continue;
    const Transform<T> wanted{now.rotation, now.translation};
    const std::array<T, 6> moved = joint_offset<T>(s.tree, i, before, wanted).value;
    d.offset = joint_offset<T>(s.tree, i, before, s.local[i]).value;
    for (int k = 0; k < s.tree.dof_count(i); ++k) d.rate[k] = s.rate[i][k] - moved[k] / h;
  }
}

SINEW_CUT_INSTANCES(template, float)
SINEW_CUT_INSTANCES(template, double)

}  // namespace sinew
