// What feet and looks do to a pose that stands in the world. Internal to this layer.
#pragma once

#include "sinew/graph/graph_ground.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// Feet that know nothing of the past.
template <class T>
void begin_feet(GraphFeetState<T>& feet);
template <class T>
void begin_look(GraphLookState<T>& look);

/// Moves the height of the ground under a character on by h seconds; before the pose is made. 0 without feet.
template <class T>
void follow_ground(const Graph& graph, GraphBlock<T>& block, const GraphGround<T>& ground, T h);

/// One character's pose and what is known of it.
template <class T>
struct GraphFinish {
  const Graph& graph;
  GraphBlock<T>& block;
  const GraphScratch<T>& scratch;
  std::span<JointJet<T>> jets;  ///< [joint], root in the world
  const GraphGround<T>& ground;
  MovingTransform<T> travel;  ///< where the character stands

  /// Both leave the pose as it is where they fail, or where joints that they need are not posed.
  Status place_feet(const TimeJet<T>& weight);
  Status look(int node, const TimeJet<T>& weight);

 private:
  Status run_feet();
};

#define SINEW_GRAPH_FINISH_INSTANCES(prefix, T)                                                  \
  prefix template void begin_feet<T>(GraphFeetState<T>&);                                        \
  prefix template void begin_look<T>(GraphLookState<T>&);                                        \
  prefix template void follow_ground<T>(const Graph&, GraphBlock<T>&, const GraphGround<T>&, T); \
  prefix template struct GraphFinish<T>;
SINEW_GRAPH_FINISH_INSTANCES(extern, float)
SINEW_GRAPH_FINISH_INSTANCES(extern, double)

}  // namespace sinew
