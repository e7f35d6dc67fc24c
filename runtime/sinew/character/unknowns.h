// Which joints of a character a step solves for, and where their solve starts and what it says of them.
// Internal to the character layer.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

/// Steps with the same contacts after which all of their forces is smooth.
constexpr int kUnchangedSteps = 2;

/// A joint is an unknown if it was released and has not come to rest on its target since, or if nothing
/// drives it.
template <class T>
void choose_unknowns(CharacterState<T>& state);

/// Hands joints whose needed torque (`problem.gradient`) exceeds their muscles' limit to the solve; and those
/// with a tone where it differs from what their animation asks for by itself, unless nothing but that and the
/// ground moves them (`bears` [body]): contacts share a weight among feet otherwise than a check does. True
/// if there were any.
template <class T>
bool release_overloaded(CharacterState<T>& state, std::span<const std::uint8_t> bears, T h);

/// Where the solve of h seconds starts: driven joints at their target, the others go on as they moved; where
/// contacts stay as they are, with the change of their speed too (flight: 2.4 passes instead of 3.4); by a
/// share of that where it would pass through something.
template <class T>
void first_guess(CharacterState<T>& state, T h, T share = T(1));

/// After a solve of h seconds: what every joint's target or muscles exert (`torque`, `limit`), and which were
/// unknowns.
template <class T>
void read_torques(CharacterState<T>& state, T h);

#define SINEW_UNKNOWNS_INSTANCES(prefix, T)                                                \
  prefix void choose_unknowns<T>(CharacterState<T>&);                                      \
  prefix bool release_overloaded<T>(CharacterState<T>&, std::span<const std::uint8_t>, T); \
  prefix void first_guess<T>(CharacterState<T>&, T, T);                                    \
  prefix void read_torques<T>(CharacterState<T>&, T);
SINEW_UNKNOWNS_INSTANCES(extern template, float)
SINEW_UNKNOWNS_INSTANCES(extern template, double)

}  // namespace sinew
