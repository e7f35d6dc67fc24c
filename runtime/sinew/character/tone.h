// What a step makes of muscles with a tone (muscle/tone.h), and when they give way.
//
// A toned joint is played like any other while what acts on it differs little from what its animation asks
// for by itself. Else it is an unknown, until it is next to its animation and slow again; or until all of the
// character is near its animation and slow, when the ordinary return takes it there without unknowns
// (hand_back).
#pragma once

#include <span>

#include "sinew/character/state.h"
#include "sinew/effects/joint_step.h"

namespace sinew {

/// Room for what is asked of muscles, which a character without a tone does not have. Set-up.
template <class T>
void reserve_for_tone(CharacterState<T>& state);

/// Keeps `problem.gradient`, a check without pushes and effects, as what the animation asks for by itself:
/// `into` feed_forward, or before.
template <class T>
void keep_feed_forward(CharacterState<T>& state, T ToneOfDof<T>::*into);

/// A part of a frame, and what joints lose in it.
template <class T>
struct PartOfFrame {
  T frame = T(0), begin = T(0), end = T(1);  ///< s; shares of it
  const JointTerm<T>* losses = nullptr;      ///< dry friction and damping; null: not declared
};

/// Slope and neutral place of every toned muscle for a part of h seconds that begins at `problem.start`,
/// whose kinematics the problem holds. What stands on a joint topples it by more, the further it leans: where
/// muscles hold it up, their stiffness comes on top of that (Gershgorin's bound of what weights do to a chain
/// of joints). A spring that pulls as where the step ends takes as much energy as a damper of kh/2 would, so
/// that much of d is left out, as far as there is any: what is left is the midpoint rule, of second order.
/// And a muscle pulls alike all through a part: with what the animation asks for in its middle, and what the
/// joint loses on the animation's own way, for what is on it to stay there. O(bodies · depth).
template <class T>
void choose_tone(CharacterState<T>& state, const Vec3<T>& gravity, T h, const PartOfFrame<T>& part);

/// How much a joint's torques [dof] differ from what its animation asks for by itself (`own`: feed_forward of
/// those that a check has, asked of those that a part of a step has found), where 1 is what releases it. 0 of
/// what has no tone.
template <class T>
T tone_load(const CharacterState<T>& state, int joint, std::span<const T> torque, T ToneOfDof<T>::*own);

/// Whether any joint's do by more than `most`.
template <class T>
bool overloads_tone(const CharacterState<T>& state, std::span<const T> torque, T most);

#define SINEW_TONE_INSTANCES(prefix, T)                                                        \
  prefix void reserve_for_tone<T>(CharacterState<T>&);                                         \
  prefix void keep_feed_forward<T>(CharacterState<T>&, T ToneOfDof<T>::*);                     \
  prefix void choose_tone<T>(CharacterState<T>&, const Vec3<T>&, T, const PartOfFrame<T>&);    \
  prefix T tone_load<T>(const CharacterState<T>&, int, std::span<const T>, T ToneOfDof<T>::*); \
  prefix bool overloads_tone<T>(const CharacterState<T>&, std::span<const T>, T);
SINEW_TONE_INSTANCES(extern template, float)
SINEW_TONE_INSTANCES(extern template, double)

}  // namespace sinew
