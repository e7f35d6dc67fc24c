// Whether what a body touches, and which of its limits bear, is the same as a step ago: where it is not,
// speeds jump and forces are no smooth ones. Internal to the character layer.
#pragma once

#include <cstdint>
#include <span>

#include "sinew/character/state.h"

namespace sinew {

/// Order-independent digest of the contacts that touch tree `tree` of a solve at the present pose.
template <class T>
std::uint64_t touching(std::span<const Contact<T>> contacts, int tree);

/// The same of those that are predicted (constant velocity and gravity) to touch in h seconds. Contacts stand
/// at the step's beginning.
template <class T>
std::uint64_t touching_soon(std::span<const Contact<T>> contacts, int tree,
                            std::span<CharacterState<T>* const> states, const Vec3<double>& gravity, T h);

/// Order-independent digest of a tree's joint limits that bear at the present pose.
template <class T>
std::uint64_t bearing(const TreeProblem<T>& problem);

#define SINEW_TOUCH_DIGEST_INSTANCES(prefix, T)                                                       \
  prefix std::uint64_t touching<T>(std::span<const Contact<T>>, int);                                 \
  prefix std::uint64_t touching_soon<T>(std::span<const Contact<T>>, int,                             \
                                        std::span<CharacterState<T>* const>, const Vec3<double>&, T); \
  prefix std::uint64_t bearing<T>(const TreeProblem<T>&);
SINEW_TOUCH_DIGEST_INSTANCES(extern template, float)
SINEW_TOUCH_DIGEST_INSTANCES(extern template, double)

}  // namespace sinew
