// Small rigs for what is done to a pose after sampling and blending.
#pragma once

#include <string>

#include "sinew/animation/foot_placement_job.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/animation/mirror_job.h"

namespace sinew::bench {

/// All joints in pairs.
inline MirrorMap<float> mirror_map(int joints) {
  Skeleton skeleton;
  skeleton.joints.resize(std::size_t(joints));
  for (int i = 0; i < joints; ++i)
    skeleton.joints[std::size_t(i)].name = (i % 2 == 0 ? "l" : "r") + std::to_string(i / 2);
  MirrorMap<float> map;
  (void)build_mirror_map(skeleton, map);
  return map;
}

/// Pelvis and two legs, locked, the ground where the feet hang.
inline bool place_feet(FootState<float> (&states)[2]) {
  static const int parents[] = {-1, 0, 1, 2, 0, 4, 5};
  JointJet<float> jets[7];
  for (const int joint : {2, 3, 5, 6}) jets[joint].translation << 0.05f, 0, -0.4f;
  FootLeg<float> legs[2] = {{1, 2, 3}, {4, 5, 6}};
  for (FootLeg<float>& leg : legs) {
    leg.toe << 0.15f, 0, -0.05f;
    leg.bend << 1, 0, 0;
  }
  const GroundHit<float> hits[2] = {{{0, 0, -0.85f}}, {{0, 0, -0.85f}}};
  const FootInput<float> feet[2] = {{1, hits, {}}, {1, hits, {}}};
  FootPlacementJob<float> job;
  job.parents = parents;
  job.jets = jets;
  job.legs = legs;
  job.feet = feet;
  job.states = states;
  job.level = TimeJet<float>(-0.85f);
  job.step = 0.01f;
  return job.Run().ok();
}

/// Spine, chest, neck and head.
inline bool look(LookState<float>& state) {
  static const int parents[] = {-1, 0, 1, 2, 3};
  JointJet<float> jets[5];
  for (JointJet<float>& jet : jets) jet.translation << 0, 0, 0.2f;
  const LookChain<float> chain{4, {1, 2, 3, 4}, {0.1f, 0.2f, 0.3f, 0.4f}, 0};
  LookAtJob<float> job;
  job.parents = parents;
  job.jets = jets;
  job.chain = &chain;
  job.state = &state;
  job.target = still<float>({1, 0.5f, 1});
  return job.Run().ok();
}

}  // namespace sinew::bench
