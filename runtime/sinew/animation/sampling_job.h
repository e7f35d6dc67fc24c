// Clip → local jets of every joint, in one pass.
#pragma once

#include <span>

#include "sinew/animation/clip.h"

namespace sinew {

/// Samples a clip at a time. Stateless: cost does not depend on the time or on previous calls; allocates
/// nothing.
///
///     ω = 2·Im(p̄ p')/n,  α = 2·Im(p̄ p'')/n − ω·2(p·p')/n,  n = p·p      (no trigonometry)
///
/// Runs 8 joints at a time where the processor has AVX2, 4 elsewhere; the bits are the same.
///
/// `Run` returns an error and leaves the output unspecified when `Validate` fails. Output longer than the
/// skeleton is left untouched, shorter means fewer joints: that is level of detail.
template <class T>
struct SamplingJob {
  const Clip* clip = nullptr;  ///< valid, as `validate(const Clip&)` says
  double time = 0;             ///< s; looping clips wrap (root motion accumulates by root_step), others clamp
  double rate = 1;             ///< playback rate s: velocities scale by s, accelerations by s²
  std::span<JointJet<T>> jets = {};    ///< poses, velocities, accelerations
  std::span<Transform<T>> poses = {};  ///< poses only, at about half the cost; one or the other or both

  Status Validate() const;
  Status Run() const;
};

extern template struct SamplingJob<float>;
extern template struct SamplingJob<double>;

}  // namespace sinew
