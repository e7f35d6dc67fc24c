// Additive layers in model space: an aim offset that stays level while the body below it leans.
#pragma once

#include <span>

#include "sinew/animation/moving_transform.h"

namespace sinew {

/// What a model-space layer is: for every joint the turn, in the axes of the root's parent, from a reference
/// pose to a motion, δ = G·G_ref⁻¹ with G the joint's rotation in model space. Translations are left out. A
/// reference that moves (another clip at the same time) brings its own jets. `scratch`: two per joint.
/// `out` may be `jets`. Parents stand before their children; spans of equal length.
template <class T>
void subtract_in_model(std::span<const int> parents, std::span<const JointJet<T>> reference,
                       std::span<const JointJet<T>> jets, std::span<MovingRotation<T>> scratch,
                       std::span<JointJet<T>> out);

/// Adds such a layer: G = ((1 − w)·1 + w·δ)·G_below, written back as local rotations, with exact derivatives.
/// Local additive layers (BlendMode::kAdditive) turn about the joint's own axes, which lean with the body.
/// Joints that the layer does not touch, and whose parent it does not, keep their bits.
template <class T>
struct MeshAdditiveJob {
  std::span<const int> parents;             ///< [joint]
  std::span<JointJet<T>> jets;              ///< [joint] local, changed
  std::span<const JointJet<T>> difference;  ///< [joint] of `subtract_in_model`
  TimeJet<T> weight{T(1)};                  ///< ≥ 0
  std::span<const T> mask = {};             ///< [joint] in [0, 1]; empty = 1
  std::span<MovingRotation<T>> scratch;     ///< two per joint

  Status Validate() const;  ///< what Run() refuses; `Status::index`: joint at fault
  Status Run() const;       ///< on an error `jets` are left as they were
};

#define SINEW_MESH_ADDITIVE_INSTANCES(prefix, T)                                                        \
  prefix template void subtract_in_model<T>(std::span<const int>, std::span<const JointJet<T>>,         \
                                            std::span<const JointJet<T>>, std::span<MovingRotation<T>>, \
                                            std::span<JointJet<T>>);                                    \
  prefix template struct MeshAdditiveJob<T>;
SINEW_MESH_ADDITIVE_INSTANCES(extern, float)
SINEW_MESH_ADDITIVE_INSTANCES(extern, double)

}  // namespace sinew
