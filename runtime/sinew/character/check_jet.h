// What a host may hand over as a motion: of a character's joints, of bodies that its feet stand on. Internal
// to the layers above.
#pragma once

#include <cmath>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/status.h"

namespace sinew {

/// Whether all numbers of a jet are.
template <class T>
bool is_finite(const JointJet<T>& jet) {
  return jet.rotation.coeffs().allFinite() && jet.omega.allFinite() && jet.alpha.allFinite() &&
         jet.translation.allFinite() && jet.velocity.allFinite() && jet.acceleration.allFinite();
}

/// Refuses what is not finite, turned by no rotation, or beyond what a step can carry. `index`: for the
/// status.
template <class T>
Status check_jet(const JointJet<T>& jet, int index) {
  constexpr T kFarthest = T(1e6);  // m; beyond this float has no millimetres left
  constexpr T kFastest = T(1e5);   // m/s and rad/s
  constexpr T kSharpest = T(1e8);  // m/s² and rad/s²; far beyond, a residual's square leaves float
  if (!is_finite(jet)) return Status::error(Code::kNotFinite, "a jet is not finite", index);
  if (std::abs(jet.rotation.norm() - T(1)) > T(1e-2))
    return Status::error(Code::kInvalidArgument, "a jet's rotation is not a unit quaternion", index);
  if (jet.translation.norm() > kFarthest || jet.velocity.norm() > kFastest || jet.omega.norm() > kFastest ||
      jet.acceleration.norm() > kSharpest || jet.alpha.norm() > kSharpest)
    return Status::error(Code::kOutOfRange, "a jet is absurdly far or fast", index);
  return {};
}

}  // namespace sinew
