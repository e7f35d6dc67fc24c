// Places on a character where things are held: how they move with it, and how they leave it.
#pragma once

#include <span>

#include "sinew/animation/moving_transform.h"

namespace sinew {

/// A frame that is fixed to a joint: a palm, a holster, a saddle.
template <class T>
struct Socket {
  int joint = -1;            ///< that carries it
  Transform<T> offset = {};  ///< socket → joint; a scabbard's differs from item to item
};

/// Motion of a socket, from the motions of all joints (ModelMotionJob), or (below) of those above it alone.
/// Evaluate it from the jets that are shown, after everything that changes them: then what is held does not
/// lag. `joint` is one of the skeleton's. Allocates nothing.
template <class T>
MovingTransform<T> socket_motion(const Socket<T>& socket, std::span<const MovingTransform<T>> model);
/// The same from local jets [joint], by walking up from the joint; `root` as in ModelMotionJob.
template <class T>
MovingTransform<T> socket_motion(const Socket<T>& socket, std::span<const JointJet<T>> jets,
                                 std::span<const int> parents, const MovingTransform<T>& root = {});

/// Motion of an item whose handle is in a socket. `handle`: handle → item. A second hand reaches for
/// attached(…) · its own handle, as TwoBoneJob's target, in the same frame.
template <class T>
MovingTransform<T> attached(const MovingTransform<T>& socket, const Transform<T>& handle);

/// What a body needs that is let go, as PropSettings takes it.
template <class T>
struct Release {
  Transform<T> pose;         ///< item axes, their origin at the centre of mass → model or world
  Vec3<T> velocity;          ///< m/s, of the centre of mass
  Vec3<T> angular_velocity;  ///< rad/s, model or world axes
};

/// The state of an item at the instant in which it is thrown or dropped: exactly that of the hand, its
/// centre of mass as far out as it is. `centre_of_mass`: m, item axes.
template <class T>
Release<T> release(const MovingTransform<T>& motion, const Vec3<T>& centre_of_mass);

/// In which order to evaluate things that are held: holders first. holders[i]: what holds thing i (a
/// character counts as a thing), −1 for nothing. `order`: as long, filled with all of them. Refuses holders
/// out of range and circles; `Status::index`: a thing at fault. O(things · longest chain); allocates nothing.
Status attachment_order(std::span<const int> holders, std::span<int> order);

#define SINEW_SOCKET_INSTANCES(prefix, T)                                                            \
  prefix MovingTransform<T> socket_motion<T>(const Socket<T>&, std::span<const MovingTransform<T>>); \
  prefix MovingTransform<T> socket_motion<T>(const Socket<T>&, std::span<const JointJet<T>>,         \
                                             std::span<const int>, const MovingTransform<T>&);       \
  prefix MovingTransform<T> attached<T>(const MovingTransform<T>&, const Transform<T>&);             \
  prefix Release<T> release<T>(const MovingTransform<T>&, const Vec3<T>&);
SINEW_SOCKET_INSTANCES(extern template, float)
SINEW_SOCKET_INSTANCES(extern template, double)

}  // namespace sinew
