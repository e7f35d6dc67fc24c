// The part of a snapshot that a scheme carries on: where the bodies are, were, and how they move. Internal to
// the character layer.
#pragma once

#include "sinew/character/snapshot.h"
#include "sinew/character/state.h"

namespace sinew {

/// After the pose and the joints' speeds. Works in `wanted`, `guessed` and the problem's `start`, which every
/// step makes anew.
template <class T>
void visit_history(CharacterState<T>& state, ByteStream& stream);

/// @cond
extern template void visit_history<float>(CharacterState<float>&, ByteStream&);
extern template void visit_history<double>(CharacterState<double>&, ByteStream&);
/// @endcond

}  // namespace sinew
