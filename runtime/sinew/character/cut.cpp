#include "sinew/character/cut.h"

#include <cmath>

namespace sinew {
namespace {

constexpr double kCut = 0.2;  ///< rad and m: an animation that leaps further than this in one step was cut

template <class T>
bool leaps(const Transform<T>& before, const JointJet<T>& last, T unit) {
  const T cut_cosine = std::cos(T(kCut / 2));
  return (before.translation - last.translation).norm() >= T(kCut) * unit ||
         std::abs(before.rotation.dot(last.rotation)) <= cut_cosine;
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
bool carry_over(CharacterState<T>& s, T h) {
  if (!s.root_is_kinematic() || !s.floats) return false;
  const Transform<T> before = a_step_ago(s.target[0], h);
  if (!leaps(before, s.last_target()[0], s.tree.scale.length)) return false;
  s.keep_record();
  turn<T>((before.rotation * s.local[0].rotation.conjugate()).toRotationMatrix(), s.history);
  s.history.place = before.translation.template cast<double>();
  s.local[0] = before;
  restart(before, s.target[0], s.own_last_target()[0]);
  s.pose_changed();
  s.forget_energy();
  return true;
}

template <class T>
void meet_cuts(CharacterState<T>& s, T h) {
  if (s.target_stands) return;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const JointJet<T>& now = s.target[i];
    const Transform<T> before = a_step_ago(now, h);
    if (!leaps(before, s.last_target()[i], s.tree.scale.length)) continue;
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
