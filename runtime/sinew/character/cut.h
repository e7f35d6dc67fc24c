// Animations that leap: cuts between clips, and teleports that no reset() declared.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

/// Where a joint's animation was h seconds ago, going by its velocity.
template <class T>
Transform<T> a_step_ago(const JointJet<T>& now, T h) {
  return {now.rotation * rotation_exp<T>(-h * now.omega), now.translation - h * now.velocity};
}

/// Where a character that leaps is taken.
struct Leap {
  Quat<double> turn = Quat<double>::Identity();                         ///< world
  Vec3<double> from = Vec3<double>::Zero(), to = Vec3<double>::Zero();  ///< m, of its root

  Vec3<double> of(const Vec3<double>& place) const { return to + turn * (place - from); }
};

/// The last target becomes one that led to `now`.
template <class T>
void restart(const Transform<T>& before, const JointJet<T>& now, JointJet<T>& last) {
  last.rotation = before.rotation;
  last.translation = before.translation;
  last.omega = now.omega;
  last.velocity = now.velocity;
}

/// A driven root whose animation leaps further than it could have moved takes the character along: everything
/// is set down where the new animation was a step ago, going by its velocity, and what hangs limp keeps its
/// motion relative to the root. True if it did, by `leap`. Costs one comparison else.
template <class T>
bool carry_over(CharacterState<T>& state, T h, Leap& leap);

/// What is tied to such a character, a prop or particles, goes along with it as it is.
template <class T>
void go_along(CharacterState<T>& state, const Leap& leap);

/// After a cut the joints' ways back start from where they are as seen from the new animation a step ago. The
/// offset from the old one would throw them about.
template <class T>
void meet_cuts(CharacterState<T>& state, T h);

#define SINEW_CUT_INSTANCES(prefix, T)                      \
  prefix bool carry_over<T>(CharacterState<T>&, T, Leap&);  \
  prefix void go_along<T>(CharacterState<T>&, const Leap&); \
  prefix void meet_cuts<T>(CharacterState<T>&, T);
SINEW_CUT_INSTANCES(extern template, float)
SINEW_CUT_INSTANCES(extern template, double)

}  // namespace sinew
