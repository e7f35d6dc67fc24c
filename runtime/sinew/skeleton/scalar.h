// What templates ask of their scalar beyond arithmetic, so that float, double and packs of them (pack.h) run
// through the same source: decisions on values are selections, never branches, where lanes may differ.
#pragma once

namespace sinew {

/// The number that a scalar is made of: T itself, or what the lanes of a pack hold. Constants that all lanes
/// share are of this type.
template <class T>
struct NumberOf {
  using Type = T;
};
template <class T>
using Number = typename NumberOf<T>::Type;

/// `yes` where the mask is set. A scalar's mask is a bool; packs bring their own overloads.
template <class T>
T select(bool mask, const T& yes, const T& no) {
  return mask ? yes : no;
}
inline bool both(bool a, bool b) {
  return a && b;
}
/// Whether the mask of any lane is set.
inline bool any(bool mask) {
  return mask;
}

/// As std::max and std::min, lane by lane.
template <class T>
T largest(const T& a, const T& b) {
  return select(a < b, b, a);
}
template <class T>
T smallest(const T& a, const T& b) {
  return select(b < a, b, a);
}

}  // namespace sinew
