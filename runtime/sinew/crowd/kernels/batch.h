// The check of one batch of characters: one lane per character, one source, compiled for every instruction
// set.
//
// Arguments are plain numbers and pointers, for the reason that animation/kernels/kernels.h gives, or made of
// floats whose alignment no instruction set changes. Nothing is contracted to fused multiply-add and lanes
// never meet, so a character's numbers depend neither on its neighbours, nor on the width of the batch, nor
// on the instruction set.
#pragma once

#include <cstddef>

#include "sinew/crowd/kernels/sample.h"
#include "sinew/effects/support.h"

namespace sinew::crowd_kernels {

/// What the characters of a batch share.
struct Rig {
  const Tree<float>* tree = nullptr;
  const SupportPoints<float>* support = nullptr;  ///< null: no ground
  const int* parent = nullptr;                    ///< [joint], those that ride along included
  int joints = 0;                                 ///< the bodies come first
  int first_checked_dof = 0;  ///< those before belong to a root that follows whatever it takes
  float gravity[3] = {};      ///< m/s²
  float ground_height = 0;    ///< m
};

struct Batch {
  /// Local, the root's in the world: as sampling a batch gives them, see JetRows, or [lane][joint].
  const float* rows = nullptr;
  const kernels::JetLayout<float>* jets = nullptr;
  kernels::PoseLayout<float>* model[kMaxLanes] = {};  ///< [lane] → [joint] → world; all or none
  const float* inverse_plus = nullptr;   ///< [dof][lane] 1 / muscle limit in the positive direction, 1/(N·m)
  const float* inverse_minus = nullptr;  ///< [dof][lane]
  float* torque = nullptr;               ///< [dof][lane] N·m (N for translations)
  float* peak = nullptr;                 ///< [lane] largest |torque| / limit; NaN where a jet is
  float* velocity = nullptr;             ///< [3][lane] m/s, of the root in the world
  void* scratch = nullptr;               ///< check_scratch_bytes(), aligned to 64
};

/// Numbers per lane that a check keeps, see Scratch in batch.inl.
constexpr int kBodyPacks = 42, kJointPacks = 7, kPointPacks = 4;

/// What a check of 16 lanes or fewer works in.
constexpr std::size_t check_scratch_bytes(int bodies, int joints, int points) {
  return kMaxLanes * sizeof(float) *
         (std::size_t(bodies) * kBodyPacks + std::size_t(joints) * kJointPacks +
          std::size_t(points) * kPointPacks);
}

#define SINEW_CROWD_KERNELS                                  \
  void sample8(const Instant& instant, const JetRows& out);  \
  void sample16(const Instant& instant, const JetRows& out); \
  void check8(const Rig& rig, const Batch& batch);           \
  void check16(const Rig& rig, const Batch& batch);
namespace baseline {
SINEW_CROWD_KERNELS
}
namespace avx2 {
SINEW_CROWD_KERNELS
}
namespace avx512 {
SINEW_CROWD_KERNELS
}

}  // namespace sinew::crowd_kernels
