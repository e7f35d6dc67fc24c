// Edges inside of a surface that several shapes make up together, as the tiles of a floor do: whoever comes
// along it meets none of them.
#pragma once

#include <span>

#include "sinew/character/state.h"

namespace sinew {

constexpr double kSamePlane = 0.99;  ///< cosine of normals that count as one
/// The same of what passes at speed: along a normal that leans by more it would be thrown up.
constexpr double kSameNormal = 0.9999;
constexpr double kSameLevel = 1e-3;  ///< m of a human, that surfaces may differ by in height and be one

/// Whether a contact is with an edge inside of the surface that its shape and another make up that the same
/// point meets (an edge or a solid: the same body): at the nearest of the edge the other's normal is one of
/// both, that of the contact is not, and the two are level within `tolerance` (m); or the contact's leads
/// into the other, as at the foot of a wall. By the poses in the problems of `states`, by which `contacts`
/// number their trees; they stand in the order of their first trees. O(those of its own), and 0.1 µs for each
/// that the same point meets along another normal.
template <class T>
bool is_internal_edge(const Contact<T>& edge, std::span<const Contact<T>> contacts, T tolerance,
                      std::span<CharacterState<T>* const> states);

/// @cond
extern template bool is_internal_edge(const Contact<float>&, std::span<const Contact<float>>, float,
                                      std::span<CharacterState<float>* const>);
extern template bool is_internal_edge(const Contact<double>&, std::span<const Contact<double>>, double,
                                      std::span<CharacterState<double>* const>);
/// @endcond

}  // namespace sinew
