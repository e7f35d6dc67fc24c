// The check of one batch of characters: one lane per character, one source, compiled for every instruction
// set.
//
// Arguments are plain numbers and pointers, for the reason that animation/kernels/kernels.h gives, or made of
// floats whose alignment no instruction set changes. Nothing is contracted to fused multiply-add and lanes
// never meet, so a character's numbers depend neither on its neighbours, nor on the width of the batch, nor
// on the instruction set.
#pragma once

#include <cstddef>

#include "sinew/animation/kernels/kernels.h"
#include "sinew/effects/support.h"

namespace sinew::crowd_kernels {

constexpr int kMaxLanes = 16;

/// What the characters of a batch share.
struct Rig {
  const Tree<float>* tree = nullptr;
  const SupportPoints<float>* support = nullptr;  ///< null: no ground
  int first_checked_dof = 0;  ///< those before belong to a root that follows whatever it takes
  float gravity[3] = {};      ///< m/s²
  float ground_height = 0;    ///< m
};

struct Batch {
  const kernels::JetLayout<float>* jets = nullptr;    ///< [lane][joints] local, the root's in the world
  int joints = 0;                                     ///< of the skeleton: the bodies come first
  kernels::PoseLayout<float>* model[kMaxLanes] = {};  ///< [lane] → [body] joint → world; all or none
  const float* inverse_plus = nullptr;   ///< [dof][lane] 1 / muscle limit in the positive direction, 1/(N·m)
  const float* inverse_minus = nullptr;  ///< [dof][lane]
  float* torque = nullptr;               ///< [dof][lane] N·m (N for translations)
  float* peak = nullptr;                 ///< [lane] largest |torque| / limit; NaN where a jet is
  void* scratch = nullptr;               ///< scratch_bytes(), aligned to 64
};

constexpr int kBodyPacks = 49,
              kPointPacks = 4;  ///< numbers per lane that a check keeps, see Scratch in batch.inl

/// What a check of 16 lanes or fewer works in.
constexpr std::size_t scratch_bytes(int bodies, int points) {
  return kMaxLanes * sizeof(float) * (std::size_t(bodies) * kBodyPacks + std::size_t(points) * kPointPacks);
}

#define SINEW_CROWD_KERNELS                        \
  void check8(const Rig& rig, const Batch& batch); \
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
