// The kinds of joints and their degrees of freedom.
#pragma once

#include <cstdint>

namespace sinew {

/// How a simulated joint may move relative to its rest frame.
/// Degrees of freedom, in this order: revolute/prismatic 1 (along `axis`), universal 2 (about `axis`, then
/// `axis2`), ball 3 (rotation vector in child axes), planar 3 (translation along the two axes normal to
/// `axis`, then rotation about it), free 6 (translation in parent axes, then rotation vector in parent axes),
/// translation 3 (in parent axes: a particle).
enum class JointType : std::uint8_t {
  kFixed,
  kRevolute,
  kPrismatic,
  kUniversal,
  kBall,
  kPlanar,
  kFree,
  kTranslation
};

/// Degrees of freedom of a joint of that type, 0 to 6.
constexpr int dof_count(JointType type) {
  constexpr int counts[] = {0, 1, 1, 2, 3, 3, 6, 3};
  return counts[static_cast<int>(type)];
}

}  // namespace sinew
