// Characters that their muscles can carry along: the pose is the clip's. Internal to the character layer.
#pragma once

#include "sinew/character/contact_finder.h"

namespace sinew {

/// Plays the clip and asks the residual pass whether the muscles can do it. False, with nothing moved, where
/// they can't. Leaves the history behind, and the report's totals to whoever asks for them.
template <class T>
bool play(CharacterState<T>& state, const WorldSettings& world, const StepPlan<T>& plan, T h);

/// Plays the clip without asking: what is off it goes back smoothly. Leaves the history behind.
template <class T>
void follow(CharacterState<T>& state, const WorldSettings& world, T h);

/// Makes the joint speeds and the history of a character that was played: poses and speeds that it has now.
/// `jets` is room for its bodies.
template <class T>
void catch_up(CharacterState<T>& state, std::vector<JointJet<T>>& jets);

#define SINEW_PLAYBACK_INSTANCES(prefix, T)                                             \
  prefix bool play<T>(CharacterState<T>&, const WorldSettings&, const StepPlan<T>&, T); \
  prefix void follow<T>(CharacterState<T>&, const WorldSettings&, T);                   \
  prefix void catch_up<T>(CharacterState<T>&, std::vector<JointJet<T>>&);
SINEW_PLAYBACK_INSTANCES(extern template, float)
SINEW_PLAYBACK_INSTANCES(extern template, double)

}  // namespace sinew
