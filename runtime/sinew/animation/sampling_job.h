// Clip → local jets of every joint, in one pass.
#pragma once

#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"

namespace sinew {

/// Samples a clip at a time. Stateless: cost does not depend on the time or on previous calls; allocates
/// nothing.
///
///     ω = 2·Im(p̄ p')/n,  α = 2·Im(p̄ p'')/n − ω·2(p·p')/n,  n = p·p      (no trigonometry)
///
/// Time is a motion τ(t), and the chain rule exact: ω = τ'·ω_clip, α = τ'²·α_clip + τ''·ω_clip, translations
/// alike. So slow motion, synchronised cycles and warps keep their accelerations. Within a clip and over the
/// seam of a loop the result is as smooth as τ (C² at least for cubic clips); where a clip that does not loop
/// begins or ends its pose is held, and velocity jumps to 0.
///
/// Runs 8 joints at a time where the processor has AVX2, 4 elsewhere; the bits are the same.
///
/// `Run` returns an error and leaves the output unspecified when `Validate` fails. Output longer than the
/// skeleton is left untouched, shorter means fewer joints: that is level of detail.
template <class T>
struct SamplingJob {
  const Clip* clip = nullptr;  ///< valid, as `validate(const Clip&)` says
  ClipTime time;  ///< a number alone: normal speed. Loops wrap (root_step accumulates), others hold the ends
  std::span<JointJet<T>> jets = {};    ///< poses, velocities, accelerations
  std::span<Transform<T>> poses = {};  ///< poses only, at about half the cost; one or the other or both

  /// What Run() refuses: no clip; a time that is not finite, or absurd (|τ| > 1e9 s, |τ'| > 1e4,
  /// |τ''| > 1e7 1/s).
  Status Validate() const;
  Status Run() const;  ///< see above
};

extern template struct SamplingJob<float>;
extern template struct SamplingJob<double>;

}  // namespace sinew
