// The check of one batch of characters: one lane per character, one source, compiled for every instruction
// set.
//
// Plain numbers and pointers only, for the reason that animation/kernels/kernels.h gives. Nothing is
// contracted to fused multiply-add and lanes never meet, so a character's numbers depend neither on its
// neighbours, nor on the width of the batch, nor on the instruction set.
#pragma once

#include <cstddef>

#include "sinew/animation/kernels/kernels.h"

namespace sinew::crowd_kernels {

constexpr int kMaxLanes = 16;

/// In the order of JointType.
enum class Freedom { kFixed, kRevolute, kPrismatic, kUniversal, kBall, kPlanar, kFree };

/// One simulated joint of the rig, shared by all lanes.
struct RigBody {
  int parent = -1;
  Freedom freedom = Freedom::kFixed;
  int first_dof = 0;
  int dof_count = 0;
  float mass = 0;         ///< kg
  float first[3] = {};    ///< mass · centre of mass, joint axes, kg·m
  float inertia[6] = {};  ///< about the joint's origin, joint axes: xx yy zz xy xz yz, kg·m²
  float axis[3][3] = {};  ///< see project() in batch.inl: child axes, or parent axes where said there
  int first_point = 0, point_count = 0;  ///< that may stand on the ground
  float bound = 0;  ///< m, from the joint's origin to the furthest of them, radius included
};

struct RigPoint {
  float local[3] = {};  ///< m, joint axes
  float radius = 0;     ///< m
};

struct Rig {
  const RigBody* bodies = nullptr;
  int body_count = 0;
  const RigPoint* points = nullptr;
  int first_checked_dof = 0;  ///< those before belong to a root that follows whatever it takes
  int dof_count = 0;
  float gravity[3] = {};  ///< m/s²
  bool ground = false;
  float ground_height = 0;  ///< m
  float support_reach = 0;  ///< m, as SupportSettings
  float support_lean = 0;
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

constexpr int kBodyPacks = 43,
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
