// Characters that their muscles can carry along: the pose is the clip's. Internal to the character layer.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

/// Plays the clip and asks the residual pass whether the muscles can do it. False, with nothing moved, where
/// they can't.
template <class T>
bool play(CharacterState<T>& state, const WorldSettings& world, T h);

extern template bool play<float>(CharacterState<float>&, const WorldSettings&, float);
extern template bool play<double>(CharacterState<double>&, const WorldSettings&, double);

}  // namespace sinew
