// What a game knows of the ground that a character goes over.
#pragma once

#include <span>

#include "sinew/animation/foot_lock.h"

namespace sinew {

/// Asked by feet of a graph (NodeType::kFeet), in world space, on the caller's thread: about a dozen times a
/// character and frame. Without it the ground is level, at the height that the graph's `level` says.
template <class T>
struct GraphGround {
  /// The highest ground below a point, m; false where there is none within reach: what was known stays.
  bool (*below)(const void* host, const Vec3<T>& point, GroundHit<T>& hit) = nullptr;
  const void* host = nullptr;                       ///< what `below` gets
  std::span<const MovingTransform<T>> bodies = {};  ///< [GroundHit::ground] body → world
};

}  // namespace sinew
