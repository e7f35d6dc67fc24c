// Where a character's graph goes in a frame: states, weights, times and events, without any pose.
#pragma once

#include "sinew/animation/event_job.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// Moves a character's graph on by `h` seconds and leaves in `scratch` what GraphPoseJob has to do. Order of
/// a frame: conditions look at what the game has set and at the frame before; transitions that are taken
/// begin at the frame's start; inputs go through their filters; times, phases and weights are those of its
/// end; events between the two are reported.
///
/// At most one transition a machine and frame, conduits not counted. Any h from 0 to 1 s; the same parameters
/// give the same bits. Allocates nothing. Cost grows with the nodes that play, not with those there are.
template <class T>
struct GraphUpdateJob {
  const Graph* graph = nullptr;        ///< the one that `state` and `scratch` were made for
  std::span<std::byte> state;          ///< the character's block, see start_graph()
  T h = 0;                             ///< s
  GraphScratch<T>* scratch = nullptr;  ///< of the caller's thread; left for GraphPoseJob
  EventSink* events = nullptr;         ///< where wanted; EventSink::lost counts what found no place

  /// Refuses a block or scratch of another graph, and an `h` that is not finite or not from 0 to 1 s.
  Status Validate() const;
  /// With an error from Validate() nothing has moved.
  Status Run() const;
};

extern template struct GraphUpdateJob<float>;
extern template struct GraphUpdateJob<double>;

}  // namespace sinew
