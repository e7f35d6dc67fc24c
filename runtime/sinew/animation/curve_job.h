// Numbers that clips move beside the joints: how strong an arm is, how far a face smiles, how much an effect
// counts. Each with its velocity and acceleration.
#pragma once

#include <span>

#include "sinew/animation/blending_job.h"
#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"

namespace sinew {

/// A clip's curves at a time, into one value per slot. A slot that the clip does not move is at its `rest`,
/// not at 0. Stateless, allocates nothing; cost does not depend on the time.
///
/// By the chain rule c(τ(t)): rate = τ'·c', acceleration = τ'²·c'' + τ''·c'. As smooth as τ, C² at most;
/// where a clip that does not loop begins or ends, the value stays and its rate jumps to 0.
template <class T>
struct CurveJob {
  const Clip* clip = nullptr;        ///< valid, as `validate(const Clip&)` says
  ClipTime time;                     ///< as of SamplingJob
  std::span<const CurveSlot> slots;  ///< of the asset
  std::span<TimeJet<T>> values;      ///< [slot]; shorter than `slots` means fewer

  Status Validate() const;  ///< what Run() refuses: no clip, or a time that is not finite
  Status Run() const;       ///< on an error `values` are left as they were
};

/// One layer of numbers, as BlendLayer is one of joints. Leaves slots beyond its `values` alone.
template <class T>
struct CurveLayer {
  std::span<const TimeJet<T>> values;   ///< [slot]
  TimeJet<T> weight{T(1), T(0), T(0)};  ///< ≥ 0, its rates by the product rule
  std::span<const T> mask = {};         ///< [slot] in [0, 1]; empty = 1 everywhere
  BlendMode mode = BlendMode::kMix;     ///< kAdditive: `values` are what is added
};

/// Blends curves as BlendingJob does joints: mixed layers first, whatever their place, then the others in
/// order. A slot that no mixed layer reaches is at its `rest`. Allocates nothing; `out` may be one of the
/// layers.
template <class T>
struct CurveBlendingJob {
  std::span<const CurveLayer<T>> layers;  ///< any number
  std::span<const CurveSlot> slots;       ///< of the asset; beyond them `rest` is 0
  std::span<TimeJet<T>> out;              ///< [slot]

  Status Validate() const;  ///< `Status::index`: layer at fault
  Status Run() const;       ///< on an error `out` is left as it was
};

extern template struct CurveJob<float>;
extern template struct CurveJob<double>;
extern template struct CurveBlendingJob<float>;
extern template struct CurveBlendingJob<double>;

}  // namespace sinew
