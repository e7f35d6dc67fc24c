// Continuous detection: how far a tree may be guessed ahead before it passes through something.
//
// A solve that starts beyond a wall finds the minimum beyond the wall. Started where the guessed motion first
// touches, its contact rows are half spaces that hold however fast the body is, and the end of the step comes
// to lie in front. Nothing is split, nothing is simulated twice.
#pragma once

#include <span>

#include "sinew/character/state.h"

namespace sinew {

/// Writes to `share` [tree] which part of the motion from `problem.start` to `problem.local` is free, in
/// [0, 1], by conservative advancement of the contacts' features against solid shapes. Contacts must stand at
/// the beginning of the step, as must the kinematics. Allocates nothing; free of cost where nothing moves
/// further than half a thickness.
template <class T>
void sweep(std::span<CharacterState<T>* const> states, std::span<const Contact<T>> contacts, T h,
           std::span<T> share);

extern template void sweep<float>(std::span<CharacterState<float>* const>, std::span<const Contact<float>>,
                                  float, std::span<float>);
extern template void sweep<double>(std::span<CharacterState<double>* const>, std::span<const Contact<double>>,
                                   double, std::span<double>);

}  // namespace sinew
