// Continuous detection: how far a tree may be guessed ahead before it passes through something.
//
// A solve that starts beyond a wall finds the minimum beyond the wall. Started where the guessed motion first
// touches, its contact rows are half spaces that hold however fast the body is, and the end of the step comes
// to lie in front. Nothing is split, nothing is simulated twice.
#pragma once

#include "sinew/effects/island_effect.h"

namespace sinew {

/// By conservative advancement of the contacts' features against solid shapes. Free of cost where nothing
/// moves further than half a thickness.
template <class T>
class ContinuousDetection final : public IslandEffect<T> {
 public:
  using typename IslandEffect<T>::Trees;  ///< all that is solved together

  /// Nothing: it works in the trees' own memory.
  void reserve(const SolveCapacity& /*capacity*/) override {}
  /// Of the object alone.
  std::size_t bytes(const SolveCapacity& /*capacity*/) const override { return sizeof *this; }
  /// Lowers `share` [tree] of both sides of a contact to the part of the guess after which they first touch.
  void limit_guess(Trees trees, std::span<const Contact<T>> contacts, T h, std::span<T> share) override;
  /// Whether they touch at any time of the guess; never with a plane, which nothing passes.
  bool meets_on_the_way(Trees trees, const Contact<T>& contact) const override;
};

extern template class ContinuousDetection<float>;
extern template class ContinuousDetection<double>;

}  // namespace sinew
