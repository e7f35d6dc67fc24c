// The joints that share a look.
#pragma once

#include <span>

#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Who looks. Built once.
template <class T>
struct LookChain {
  static constexpr int kMost = 8;  ///< joints
  int count = 0;                   ///< of joints, 1 … kMost
  int joints[kMost] = {};  ///< from the root outwards, one below the other; the last one is what looks
  T shares[kMost] = {};    ///< of the turn, > 0; sum 1
  int base = -1;           ///< above the first joint: angles are measured in its axes; −1: model space
  Vec3<T> forward = Vec3<T>::UnitX();  ///< base axes, unit: yaw and pitch are 0 there
  Vec3<T> up = Vec3<T>::UnitZ();       ///< base axes, unit, at right angles to `forward`
  Vec3<T> axis = Vec3<T>::UnitX();     ///< of the last joint, unit: where it looks
};

/// Chest, neck and head by their roles (spine too, if there is one), shares 0.1, 0.2, 0.3, 0.4 of the whole;
/// they look along the model's x axis at rest. Errors if there is no head.
template <class T>
Status find_look_chain(const Skeleton& skeleton, LookChain<T>& out);

/// The same of any joints, from the root outwards, one below the other; the last one is what looks. `shares`
/// [joint] > 0, which need not add up to 1.
template <class T>
Status make_look_chain(const Skeleton& skeleton, std::span<const int> joints, std::span<const double> shares,
                       LookChain<T>& out);

/// @cond
extern template Status make_look_chain<float>(const Skeleton&, std::span<const int>, std::span<const double>,
                                              LookChain<float>&);
extern template Status make_look_chain<double>(const Skeleton&, std::span<const int>, std::span<const double>,
                                               LookChain<double>&);
extern template Status find_look_chain<float>(const Skeleton&, LookChain<float>&);
extern template Status find_look_chain<double>(const Skeleton&, LookChain<double>&);
/// @endcond

}  // namespace sinew
