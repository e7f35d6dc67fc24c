// Characters that their muscles can carry along: the pose is the clip's. Internal to the character layer.
#pragma once

#include "sinew/character/contact_finder.h"
#include "sinew/effects/check_pass.h"

namespace sinew {

/// Whether a check of the animation asks for nothing but the residual pass and the floor's support: no force
/// from outside, no effect.
template <class T>
bool has_plain_check(const CharacterState<T>& state);

/// What a check is made with.
template <class T>
struct CheckContext {
  const WorldSettings& world;
  const StepPlan<T>& plan;
  const GroundProbe<T>* ground = nullptr;  ///< null: nothing but the floor is near (nearby.h)
  CheckScratch<T> scratch;
};

/// Whether the ground bears what a driven root would: the floor, or what else there is.
template <class T>
bool stands(const CharacterState<T>& state, const WorldSettings& world, const StepPlan<T>& plan,
            const GroundProbe<T>* ground);

/// Plays the clip and asks the residual pass whether the muscles can do it. False, with nothing moved, where
/// they can't. Leaves the history behind, and the totals to whoever asks for them. The scratch must
/// be one of the rig's size.
template <class T>
bool play(CharacterState<T>& state, T h, const CheckContext<T>& context);

/// The same where `state.problem.gradient` holds what the muscles would have to give.
template <class T>
bool play_checked(CharacterState<T>& state, const WorldSettings& world, T h);

/// Whether it has only the ground, is on its animation, and nothing pushes it.
template <class T>
bool may_be_led(const CharacterState<T>& state);

/// Before a solve, of who may be led and meets nothing but the ground: as long as that and its help bear its
/// root, and an invisible hand what its animation's accelerations ask of no floor that there could be, the
/// root is where the animation has it, whatever its joints do. O(points).
template <class T>
void lead_root(CharacterState<T>& state, const CheckContext<T>& context);

/// Before a solve, of whom his host gives a hand: what his target asks of no floor that there could be, his
/// help may be more by. O(points).
template <class T>
void give_hand(CharacterState<T>& state, const CheckContext<T>& context);

/// Before a solve of a step of h seconds, of muscles with a tone: what the animation asks of each by itself,
/// with the ground's share; and which are to give way to pushes and effects. Ends a return. O(bodies).
template <class T>
void begin_tone(CharacterState<T>& state, T h, const CheckContext<T>& context);

/// What held a grounded root besides the ground, into the report.
template <class T>
void report_help(CharacterState<T>& state);

/// Plays the clip without asking: what is off it goes back smoothly. Leaves the history behind.
template <class T>
void follow(CharacterState<T>& state, const WorldSettings& world, T h);

/// Makes the joint speeds and the history of a character that was played: poses and speeds that it has now.
/// `jets` is room for its bodies: memory that is reserved, or, as a span, that is there.
template <class T>
void synchronise(CharacterState<T>& state, std::vector<JointJet<T>>& jets);
template <class T>
void synchronise(CharacterState<T>& state, std::span<JointJet<T>> jets);

#define SINEW_PLAYBACK_INSTANCES(prefix, T)                                                 \
  prefix bool has_plain_check<T>(const CharacterState<T>&);                                 \
  prefix bool stands<T>(const CharacterState<T>&, const WorldSettings&, const StepPlan<T>&, \
                        const GroundProbe<T>*);                                             \
  prefix bool play<T>(CharacterState<T>&, T, const CheckContext<T>&);                       \
  prefix bool play_checked<T>(CharacterState<T>&, const WorldSettings&, T);                 \
  prefix bool may_be_led<T>(const CharacterState<T>&);                                      \
  prefix void lead_root<T>(CharacterState<T>&, const CheckContext<T>&);                     \
  prefix void give_hand<T>(CharacterState<T>&, const CheckContext<T>&);                     \
  prefix void begin_tone<T>(CharacterState<T>&, T, const CheckContext<T>&);                 \
  prefix void report_help<T>(CharacterState<T>&);                                           \
  prefix void follow<T>(CharacterState<T>&, const WorldSettings&, T);                       \
  prefix void synchronise<T>(CharacterState<T>&, std::vector<JointJet<T>>&);                \
  prefix void synchronise<T>(CharacterState<T>&, std::span<JointJet<T>>);
SINEW_PLAYBACK_INSTANCES(extern template, float)
SINEW_PLAYBACK_INSTANCES(extern template, double)

}  // namespace sinew
