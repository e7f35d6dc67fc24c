// How long is a transition to be? Asked by whoever plays motions, answered by who knows the muscles.
#pragma once

#include "sinew/animation/inertialize_job.h"

namespace sinew {

/// Of a transition that begins. Both motions are those of the instant of the change.
template <class T>
struct FadeQuestion {
  std::span<const JointJet<T>> destination;  ///< [joint] the motion gone to, its root in the world
  const InertialState<T>* offset = nullptr;  ///< of what was shown from that; elapsed 0, duration `most`
  T budget = T(0.5);                         ///< which share of what muscles can spare may go into it
  T least = T(0.08);                         ///< s, the shortest that there is
  T most = T(0.6);                           ///< s, the longest that it may be
};

}  // namespace sinew
