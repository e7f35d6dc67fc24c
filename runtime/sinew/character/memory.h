// What a world's parts take from the heap, without what the allocator adds. Internal to the character layer.
#pragma once

#include "sinew/character/state.h"
#include "sinew/effects/coupling.h"

namespace sinew {

/// Of one member of something: a vector's elements, what a history or a motion holds; 0 of a plain value.
template <class T>
std::size_t bytes_held(const T&) {
  return 0;
}
template <class Element>
std::size_t bytes_held(const std::vector<Element>& v) {
  return v.capacity() * sizeof(Element);
}
template <class T>
std::size_t bytes_held(const History<T>& h) {
  return bytes_held(h.center) + bytes_held(h.velocity) + bytes_held(h.rotation) +
         bytes_held(h.rotation_rate) + bytes_held(h.momentum) + bytes_held(h.acceleration) +
         bytes_held(h.torque) + bytes_held(h.other);
}
template <class T>
std::size_t bytes_held(const Motion<T>& m) {
  return bytes_held(m.body) + bytes_held(m.omega) + bytes_held(m.velocity) + bytes_held(m.origin_velocity);
}

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
