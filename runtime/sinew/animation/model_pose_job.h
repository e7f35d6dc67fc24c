// Local transforms → model space, for drawing and skinning.
#pragma once

#include <span>

#include "sinew/animation/clip.h"

namespace sinew {

/// Chains every joint to its parent: model[i] = model[parent]·local[i]. One of `jets` and `poses` is read.
/// Output shorter than the skeleton means fewer joints. Allocates nothing. `model` may be `poses`.
template <class T>
struct ModelPoseJob {
  std::span<const int> parents;              ///< [joint] before the joint, or -1: its parent is `root`
  std::span<const JointJet<T>> jets = {};    ///< local
  std::span<const Transform<T>> poses = {};  ///< local
  Transform<T> root = {};                    ///< where the model stands
  std::span<Transform<T>> model;             ///< joint → model (times `root`)

  Status Validate() const;  ///< `Status::index`: joint at fault
  Status Run() const;       ///< on an error `model` is left as it was
};

extern template struct ModelPoseJob<float>;
extern template struct ModelPoseJob<double>;

}  // namespace sinew
