// Rest: what is still falls asleep with everything near it, and costs nothing until something wakes it.
// Internal to the character layer.
#pragma once

#include <span>

#include "sinew/character/state.h"
#include "sinew/effects/coupling.h"

namespace sinew {

/// Whether the host's doings since the last step wake a sleeper.
template <class T>
bool is_woken(const CharacterState<T>& state);

/// After an island's step of h seconds: puts it to sleep where all its members have been at rest long
/// enough, and no loop is being closed. `indices` are the members' numbers in the world, `ties` what they are
/// tied together with.
template <class T>
void put_to_sleep(std::span<CharacterState<T>* const> members, std::span<const int> indices,
                  std::span<Coupling<T>* const> ties, const LevelOfDetail& detail, T h);

#define SINEW_SLEEP_INSTANCES(prefix, T)                                                 \
  prefix bool is_woken<T>(const CharacterState<T>&);                                     \
  prefix void put_to_sleep<T>(std::span<CharacterState<T>* const>, std::span<const int>, \
                              std::span<Coupling<T>* const>, const LevelOfDetail&, T);
SINEW_SLEEP_INSTANCES(extern template, float)
SINEW_SLEEP_INSTANCES(extern template, double)

}  // namespace sinew
