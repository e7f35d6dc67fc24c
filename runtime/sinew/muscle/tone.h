// Tone: how stiffly a muscle stays with its animation below its limit.
//
//     τ = clamp(τ_ff − k·s − d·ṡ, −τ⁻, τ⁺)
//
// s is the joint's offset from the animation at the end of a step, ṡ how fast that changes, τ_ff the torque
// that the clip asks for by itself: who is not disturbed is exactly on it. A rigid muscle (k → ∞) is as stiff
// as its limit allows: a load below it moves nothing. The row is in joint_rows.h (RowKind::kTone), what a
// step makes of k and ζ in ../character/tone.h.
#pragma once

#include <cstdint>
#include <limits>

#include "sinew/residual/scale.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// How tense a body is.
enum class Tone : std::uint8_t {
  kRigid,    ///< as stiff as the limit allows
  kRelaxed,  ///< at ease: rings for a while
  kAlert,    ///< stands or walks attentively
  kBraced,   ///< expects the blow
};

/// Of one degree of freedom.
struct Stiffness {
  double stiffness = std::numeric_limits<double>::infinity();  ///< N·m/rad (N/m where it slides); ∞: rigid
  double damping_ratio = 0.3;  ///< ζ ≥ 0, of the joint alone with what it carries
};

/// "rigid", "relaxed", "alert" or "braced" into `tone`; else a status that lists them, and nothing is
/// written.
Status tone_named(const char* name, Tone& tone);

/// What a preset makes of one degree of freedom of a simulated joint, N·m/rad of this skeleton, whose `scale`
/// is that of scale_of(). A human's by what the joint means (Role; what lies between pelvis and head is
/// spine), times mass · stature²; of joints without a role a share of their muscles' limits. What slides and
/// the root are rigid. O(depth of the tree).
Stiffness stiffness_of(const Skeleton& skeleton, const Scale<double>& scale, int joint, int dof, Tone tone);

}  // namespace sinew
