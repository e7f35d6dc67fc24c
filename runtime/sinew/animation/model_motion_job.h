// Local jets → motions in model space: where every joint is, how fast, and how it accelerates.
#pragma once

#include <span>

#include "sinew/animation/moving_transform.h"

namespace sinew {

/// Chains every joint to its parent, as ModelPoseJob does with poses: model[i] = model[parent]·local[i], with
/// exact velocities and accelerations, Coriolis terms included. Of single joints: `model_motion`. Output
/// shorter than the skeleton means fewer joints. Allocates nothing.
template <class T>
struct ModelMotionJob {
  std::span<const int> parents;         ///< [joint] before the joint, or −1: its parent is `root`
  std::span<const JointJet<T>> jets;    ///< local
  MovingTransform<T> root = {};         ///< where the model stands and how that moves
  std::span<MovingTransform<T>> model;  ///< joint → model (times `root`)

  Status Validate() const;  ///< `Status::index`: joint at fault
  Status Run() const;       ///< on an error `model` is left as it was
};

extern template struct ModelMotionJob<float>;
extern template struct ModelMotionJob<double>;

}  // namespace sinew
