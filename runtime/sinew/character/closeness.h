// Whether two characters or props come so close that they are solved together. Internal to the character
// layer.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "sinew/character/state.h"

namespace sinew {

/// A collider where it is.
template <class T>
struct PlacedCollider {
  const Collider* collider = nullptr;
  Transform<T> pose;  ///< of the shape
  T radius = T(0);    ///< m, of the bounding sphere about the shape's centre
};

/// A collider where it is in the world, and how it moves.
template <class T>
struct MovingCollider : PlacedCollider<T> {
  Vec3<T> velocity = Vec3<T>::Zero();  ///< m/s, of its body
  T any = T(0);                        ///< m, that it may move by in any direction besides
};

/// Distance of an axis (its middle, and from there to one of its ends, which may be the same place) to a
/// collider's shape where that stands, m, and the direction in which it leaves that, in the shape's axes.
/// `along`, in [−1, 1]: where on the axis. By golden sections, for along a line it has one minimum: each
/// leaves 0.618 of the axis.
template <class T>
SignedDistance<T> distance_of_axis(const Vec3<T>& middle, const Vec3<T>& half_axis, const Transform<T>& pose,
                                   const Collider& shape, int sections, T& along);

/// Distance of two colliders (m) and the direction in which a leaves b: exact to a thousandth of a capsule's
/// length; of two polyhedra that are apart at most their distance, by the best of the axes that separate
/// them.
template <class T>
SignedDistance<T> distance_between(const PlacedCollider<T>& a, const PlacedCollider<T>& b);

/// Holds all of a state's colliders through a step of h seconds, as come_close() looks at them; world axes.
/// O(bodies) of who is played, else of colliders.
template <class T>
Eigen::AlignedBox<T, 3> swept_box(CharacterState<T>& state, T h);

/// Whether come_close() may be true of what two such boxes hold.
template <class T>
bool boxes_come_close(const Eigen::AlignedBox<T, 3>& a, const Eigen::AlignedBox<T, 3>& b, T h, T margin);

/// Appends the colliders of a state for a step of h seconds. O(colliders).
template <class T>
void append_moving(CharacterState<T>& state, T h, std::vector<MovingCollider<T>>& out);

constexpr double kCloseMargin =
    0.03;  ///< m of a human beyond what they move by: solved together, or not played

/// Whether some of two states' colliders come within `margin` (m) of each other in h seconds, as their bodies
/// move now, or faster by what accelerates them (kSurprise). By their distances, in the direction in which
/// they approach: what passes by, or falls beside, is not close. O(colliders) where they are apart, else
/// O(colliders²), and some hundred nanoseconds for each pair whose bounding spheres come close.
template <class T>
bool come_close(std::span<const MovingCollider<T>> a, std::span<const MovingCollider<T>> b, T h, T margin);

#define SINEW_CLOSENESS_INSTANCES(prefix, T)                                                             \
  prefix SignedDistance<T> distance_of_axis<T>(const Vec3<T>&, const Vec3<T>&, const Transform<T>&,      \
                                               const Collider&, int, T&);                                \
  prefix SignedDistance<T> distance_between<T>(const PlacedCollider<T>&, const PlacedCollider<T>&);      \
  prefix void append_moving<T>(CharacterState<T>&, T, std::vector<MovingCollider<T>>&);                  \
  prefix Eigen::AlignedBox<T, 3> swept_box<T>(CharacterState<T>&, T);                                    \
  prefix bool boxes_come_close<T>(const Eigen::AlignedBox<T, 3>&, const Eigen::AlignedBox<T, 3>&, T, T); \
  prefix bool come_close<T>(std::span<const MovingCollider<T>>, std::span<const MovingCollider<T>>, T, T);
SINEW_CLOSENESS_INSTANCES(extern template, float)
SINEW_CLOSENESS_INSTANCES(extern template, double)

}  // namespace sinew
