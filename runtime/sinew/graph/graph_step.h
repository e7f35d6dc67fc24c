// A frame of a character's graph: what a game calls.
#pragma once

#include <algorithm>
#include <cmath>

#include "sinew/graph/graph_pose.h"
#include "sinew/graph/graph_update.h"

namespace sinew {

/// GraphUpdateJob and GraphPoseJob one after the other. Frames longer than 1/60 s are gone through in equal
/// parts of at most that, of which all but the last pose the root alone: so that a character arrives at the
/// same place at 20 Hz as at 60, and conditions are looked at as often. Allocates nothing.
template <class T>
struct GraphStepJob {
  const Graph* graph = nullptr;                ///< the one that `state` and `scratch` were made for
  std::span<std::byte> state;                  ///< the character's block, see start_graph()
  T h = 0;                                     ///< s, 0 to 1
  GraphScratch<T>* scratch = nullptr;          ///< of the caller's thread
  std::span<JointJet<T>> jets;                 ///< [joint]: what the character is to do h seconds later
  EventSink* events = nullptr;                 ///< where wanted
  std::span<TimeJet<T>> curves = {};           ///< [slot], where wanted
  std::span<const JointJet<T>> physical = {};  ///< as of GraphPoseJob
  GraphWatch<T> watch = {};                    ///< of the last part
  GraphGround<T> ground = {};                  ///< for NodeType::kFeet
  GraphMuscles<T> muscles = {};                ///< as of GraphPoseJob

  /// The first error of GraphUpdateJob or GraphPoseJob; what one of the parts refuses leaves the others
  /// before it done.
  Status Run() const {
    const int parts =
        std::isfinite(h) && h <= T(1) ? std::max(1, static_cast<int>(std::ceil(h * T(60) - T(0.01)))) : 1;
    for (int k = 1; k <= parts; ++k) {
      const int before = events ? events->count : 0;
      if (Status status = GraphUpdateJob<T>{graph, state, h / T(parts), scratch, events}.Run(); !status)
        return status;
      for (int e = before; events && e < events->count; ++e)
        events->hits[std::size_t(e)].seconds_ago += static_cast<float>(h * T(parts - k) / T(parts));
      const std::span<JointJet<T>> posed =
          k == parts ? jets : jets.first(std::min<std::size_t>(1, jets.size()));
      GraphPoseJob<T> pose{graph, state, scratch, posed, curves, physical};
      if (k == parts) pose.watch = watch;
      pose.ground = ground;
      pose.muscles = muscles;
      if (Status status = pose.Run(); !status) return status;
    }
    return {};
  }
};

}  // namespace sinew
