// Whether colliders touch on their way through a step that their bodies have made without each other.
// Internal to the character layer.
#pragma once

#include "sinew/character/closeness.h"

namespace sinew {

/// Appends the colliders of a state with its joints at `pose` [body] (joint → parent, a floating root's at
/// `root`, m, world), about `origin` (m, world). Uses the state's room for kinematics. O(bodies + colliders).
template <class T>
void place_colliders(CharacterState<T>& state, std::span<const Transform<T>> pose, const Vec3<double>& root,
                     const Vec3<double>& origin, std::vector<PlacedCollider<T>>& out);

/// Where the colliders of a state, `from` as place_colliders() has just put them, are in h seconds: of who is
/// undisturbed as its animation has them, else as their bodies go on, falling.
template <class T>
void predict_colliders(CharacterState<T>& state, std::span<const PlacedCollider<T>> from,
                       const Vec3<double>& origin, const Vec3<T>& gravity, T h,
                       std::vector<PlacedCollider<T>>& out);

/// Colliders where a step begins and where it ends, each pair of one body.
template <class T>
struct ColliderPaths {
  std::span<const PlacedCollider<T>> from, to;
};

/// Whether some of a touch some of b on the way, or lie deeper than `depth` (m) in them; each goes evenly. By
/// halves of it, down to 1/256, as long as what they move against each other is more than they are apart at
/// its ends. O(colliders²) where the balls about their ways meet.
template <class T>
bool touch_on_the_way(const ColliderPaths<T>& a, const ColliderPaths<T>& b, T depth);

#define SINEW_TOUCHING_INSTANCES(prefix, T)                                                                  \
  prefix void place_colliders<T>(CharacterState<T>&, std::span<const Transform<T>>, const Vec3<double>&,     \
                                 const Vec3<double>&, std::vector<PlacedCollider<T>>&);                      \
  prefix void predict_colliders<T>(CharacterState<T>&, std::span<const PlacedCollider<T>>,                   \
                                   const Vec3<double>&, const Vec3<T>&, T, std::vector<PlacedCollider<T>>&); \
  prefix bool touch_on_the_way<T>(const ColliderPaths<T>&, const ColliderPaths<T>&, T);
SINEW_TOUCHING_INSTANCES(extern template, float)
SINEW_TOUCHING_INSTANCES(extern template, double)

}  // namespace sinew
