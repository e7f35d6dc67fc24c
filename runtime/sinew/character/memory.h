// What a world's parts take from the heap, without what the allocator adds. Internal to the character layer.
#pragma once

#include "sinew/character/state.h"
#include "sinew/effects/coupling.h"

namespace sinew {

template <class T>
std::size_t bytes_of(const Rig<T>& rig);

/// Without its rig.
template <class T>
std::size_t bytes_of(const CharacterState<T>& state);

template <class T>
std::size_t bytes_of(const Coupling<T>& coupling);

extern template std::size_t bytes_of<float>(const Rig<float>&);
extern template std::size_t bytes_of<double>(const Rig<double>&);
extern template std::size_t bytes_of<float>(const CharacterState<float>&);
extern template std::size_t bytes_of<double>(const CharacterState<double>&);
extern template std::size_t bytes_of<float>(const Coupling<float>&);
extern template std::size_t bytes_of<double>(const Coupling<double>&);

}  // namespace sinew
