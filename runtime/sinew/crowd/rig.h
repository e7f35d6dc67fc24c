// A skeleton as the batch kernels want it. Internal to the crowd layer.
#pragma once

#include <vector>

#include "sinew/crowd/crowd.h"
#include "sinew/effects/kernels/check.h"

namespace sinew {

struct CrowdRig {
  Tree<float> tree;
  SupportPoints<float> support;
  std::vector<float> torque_plus, torque_minus;  ///< [dof] muscle limits at strength 1, N·m
  std::vector<int> parent;                       ///< [joint]
  check_kernels::Rig view;                       ///< of the above

  CrowdRig(const Skeleton& skeleton, const CrowdSettings& settings);
  CrowdRig(const CrowdRig&) = delete;
};

}  // namespace sinew
