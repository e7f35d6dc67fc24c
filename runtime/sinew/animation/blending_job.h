// Several motions → one: weighted mixes, masked overrides and additive layers, with exact derivatives.
#pragma once

#include <cstdint>
#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/time_jet.h"

namespace sinew {

/// How a layer joins what is below it; w is its weight times its mask at a joint.
enum class BlendMode : std::uint8_t {
  kMix,       ///< weighted mean of all mixed layers: P = Σ w·p / Σ w
  kOverride,  ///< (1 − w)·below + w·layer: a cut at w = 1, with no inverse masks to keep
  kAdditive,  ///< below ∘ (w of the layer's difference, see `subtract_reference`)
};

/// One motion of a blend, and how much of it.
template <class T>
struct BlendLayer {
  std::span<const JointJet<T>> jets;  ///< [joint] local; as many as the output at least
  TimeJet<T> weight{T(1), T(0),
                    T(0)};           ///< ≥ 0; its rates make the blend's derivatives exact (see EaseWeight)
  std::span<const T> mask = {};      ///< [joint] in [0, 1]; empty = 1 everywhere
  BlendMode mode = BlendMode::kMix;  ///< how it joins what is below it
  /// Of an additive layer that is a motion: the pose that it differs from, as `subtract_reference` takes it.
  /// Empty: the layer is a difference already.
  std::span<const Transform<T>> reference = {};
};

/// Blends jets joint by joint. Rotations are summed as quaternions in R⁴ and normalised; all derivatives are
/// those of the blended pose by the product rule: P'' = Σ (w·p'' + 2w'·p' + w''·p).
///
/// Which of ±q enters the sum: with `rest` the one nearer to the rest pose, so that two layers more than half
/// a turn apart blend through rest, as a body does, whatever their order; it flips only where a joint is half
/// a turn away from rest. Without `rest` the one nearer to what is below (to the first mixed layer), which
/// flips where two layers are half a turn apart: then the pose jumps.
///
/// Mixed layers come first whatever their place in the list, the others follow in order. Exact where the mask
/// says so: at mask 0 a layer leaves the bits below it alone; at mask 1 a constant override of weight 1, or
/// the only mixed layer, gives its own bits. A joint that no mixed layer reaches rests in `rest`.
///
/// Allocates nothing. `out` may be one of the layers. Output shorter than the layers means fewer joints.
template <class T>
struct BlendingJob {
  static constexpr int kMaxLayers = 16;     ///< of one blend; Run() refuses more
  std::span<const BlendLayer<T>> layers;    ///< those of weight 0, with no rates, cost nothing
  std::span<const Transform<T>> rest = {};  ///< local transforms; empty = identity, see above
  std::span<JointJet<T>> out;               ///< [joint] local

  Status Validate() const;  ///< `Status::index`: layer at fault
  Status Run() const;       ///< on an error `out` is left as it was
};

extern template struct BlendingJob<float>;
extern template struct BlendingJob<double>;

/// What an additive layer is: the difference between a motion and a reference pose, δ = reference⁻¹·jets for
/// rotations (in child axes, so velocities stay as they are) and jets − reference for translations. `out` may
/// be `jets`.
template <class T>
void subtract_reference(std::span<const Transform<T>> reference, std::span<const JointJet<T>> jets,
                        std::span<JointJet<T>> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = jets[i];
    out[i].rotation = reference[i].rotation.conjugate() * jets[i].rotation;
    out[i].translation -= reference[i].translation;
  }
}

}  // namespace sinew
