// Hands, feet and toes that are solved for in one step of a few: the talk's "bake". Internal to the character
// layer.
//
// The talk leaves baked joints to q'' = −k·q'. A hand at the end of an arm that is struck does not do that:
// it stays behind, while q'' = −k·q' turns it with the arm as if it were welded on (limp hands then end 44°
// rms off). Here a baked joint moves by itself: its own few equations are solved where the rest of the body
// is expected to be, under what its muscles can give. It is no unknown of the optimizer, which takes its
// motion as given; only where the solve shows that the expectation was wrong does it become one.
// LevelOfDetail::baked_decay asks for the talk's own law instead, for comparisons.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

/// Which joints a part of h seconds does not solve for. `problem.target` of limp ones becomes where they go
/// on to. After choose_targets().
template <class T>
void choose_baked(CharacterState<T>& state, const LevelOfDetail& detail, T h);

/// Moves the baked joints of a solve that is about to begin, with everything else at its first guess. Those
/// that something touches stay on their way. After predict(); the state is the `index`th tree of the solve.
/// O(bodies) where something is baked.
template <class T>
void move_baked(CharacterState<T>& state, const LevelOfDetail& detail, int index,
                std::span<const Contact<T>> contacts, const StepSettings<T>& settings);

/// After a solve: makes unknowns of those baked joints that bear at a limit, or that something (a blow, a
/// contact, an arm that came to be elsewhere) would have moved by more than a little in this part. True where
/// there are any: the solve has to go on.
template <class T>
bool release_baked(CharacterState<T>& state, const LevelOfDetail& detail, const StepSettings<T>& settings);

#define SINEW_BAKING_INSTANCES(prefix, T)                                                               \
  prefix void choose_baked<T>(CharacterState<T>&, const LevelOfDetail&, T);                             \
  prefix void move_baked<T>(CharacterState<T>&, const LevelOfDetail&, int, std::span<const Contact<T>>, \
                            const StepSettings<T>&);                                                    \
  prefix bool release_baked<T>(CharacterState<T>&, const LevelOfDetail&, const StepSettings<T>&);
SINEW_BAKING_INSTANCES(extern template, float)
SINEW_BAKING_INSTANCES(extern template, double)

}  // namespace sinew
