// What the physical character says of itself, as parameters of its graph.
#pragma once

#include "sinew/animation/physics_values.h"
#include "sinew/graph/graph_state.h"

namespace sinew {

/// Sets those float parameters of a character's block whose names are in kPhysicsNames: `physics.tilt`,
/// `physics.face_up`, `physics.height`, `physics.load`, `physics.load.MASK` (of the joints that the asset's
/// mask MASK has by half or more; 0 where `values.joint_load` is empty), `physics.off_animation`,
/// `physics.contacts` and `physics.contact_force`. They are filtered as any others, if they say so. What is
/// not finite, or beyond 10⁶, is cut off there; NaN leaves the parameter as it was. Refuses what
/// check_block() does. Allocates nothing. Cost O(such parameters), of a mask's load O(joints).
template <class T>
Status set_physics(const Graph& graph, std::span<std::byte> state, const PhysicsValues<T>& values);

/// @cond
extern template Status set_physics<float>(const Graph&, std::span<std::byte>, const PhysicsValues<float>&);
extern template Status set_physics<double>(const Graph&, std::span<std::byte>, const PhysicsValues<double>&);
/// @endcond

}  // namespace sinew
