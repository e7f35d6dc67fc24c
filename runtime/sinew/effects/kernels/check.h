// The check of one batch of characters: one lane per character, one source, compiled for every instruction
// set.
//
// Arguments are plain numbers and pointers, for the reason that animation/kernels/kernels.h gives, or made of
// floats whose alignment no instruction set changes. Nothing is contracted to fused multiply-add and lanes
// never meet, so a character's numbers depend neither on its neighbours, nor on the width of the batch, nor
// on the instruction set: they are those of check_motion (check_pass.h).
#pragma once

#include <cstddef>

#include "sinew/animation/kernels/kernels.h"
#include "sinew/effects/check_pass.h"

namespace sinew::check_kernels {

constexpr int kMaxLanes = 16;
constexpr int kJetNumbers = 20;  ///< of a jet, in the order of JetLayout, padding included

/// What the characters of a batch share.
struct Rig {
  const Tree<float>* tree = nullptr;
  const SupportPoints<float>* support = nullptr;  ///< null: no ground
  const int* parent = nullptr;                    ///< [joint], those that ride along included
  int joints = 0;             ///< the bodies come first; that follow, only for model poses
  int first_checked_dof = 0;  ///< those before belong to a root that follows whatever it takes
  float gravity[3] = {};      ///< m/s²
  float ground_height = 0;    ///< m
};

struct Batch {
  /// Local, the root's in the world: [joint][kJetNumbers][lane], or [lane] → [joint].
  const float* rows = nullptr;
  const kernels::JetLayout<float>* jets[kMaxLanes] = {};
  kernels::PoseLayout<float>* model[kMaxLanes] = {};  ///< [lane] → [joint] → world; all or none
  float* torque = nullptr;                            ///< [dof][lane] N·m (N for translations)
  /// [dof][lane] 1 / muscle limit in the positive and in the negative direction, 1/(N·m), and what is found
  /// with them: [lane] largest |torque| / limit; NaN where a jet is. Null: nobody asks.
  const float *inverse_plus = nullptr, *inverse_minus = nullptr;
  float* peak = nullptr;
  float* velocity = nullptr;  ///< [3][lane] m/s, of the root in the world; null: nobody asks
  void* scratch = nullptr;    ///< check_scratch_bytes(), aligned to 64
};

/// What a check of 16 lanes or fewer works in.
constexpr std::size_t check_scratch_bytes(int bodies, int joints, int points) {
  return kMaxLanes * (CheckScratch<float>::bytes(bodies, joints, points) +
                      std::size_t(joints) * sizeof(Quat<float>));  // for model poses
}

#define SINEW_CHECK_KERNELS                        \
  void check8(const Rig& rig, const Batch& batch); \
  void check16(const Rig& rig, const Batch& batch);
namespace baseline {
SINEW_CHECK_KERNELS
}
namespace avx2 {
SINEW_CHECK_KERNELS
}
namespace avx512 {
SINEW_CHECK_KERNELS
}

}  // namespace sinew::check_kernels
