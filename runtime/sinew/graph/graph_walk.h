// What several passes over a graph share. Internal to this layer.
#pragma once

#include "sinew/animation/soft_limits.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// Puts a node and all below it where they begin; unsynchronised clips `entry` seconds later.
template <class T>
void enter_node(const Graph& graph, GraphBlock<T>& block, int node, double entry);

/// The speed of a clip that is not synchronised.
template <class T>
TimeJet<double> clip_speed(const Graph& graph, GraphBlock<T>& block, const GraphNode& node);

/// Where an unsynchronised clip is that has played for so many seconds: one that does not loop slows down in
/// the last tenth of a second and stops at its end, C², which takes it as long again.
ClipTime played_time(const Clip& clip, const TimeJet<double>& played);

/// Where a clip of the graph (Graph::clips) is at present.
template <class T>
ClipTime clip_time(const Graph& graph, GraphBlock<T>& block, int clip);

/// How much the game shows of something: a number, or a parameter between 0 and 1.
template <class T>
TimeJet<T> weight_of(GraphBlock<T>& block, const GraphValue& v) {
  return v.parameter < 0 ? TimeJet<T>(T(v.constant)) : soft_step(block.parameter(v.parameter).x);
}

template <class T>
bool nothing(const TimeJet<T>& weight) {
  return weight.value == T(0) && weight.rate == T(0) && weight.acceleration == T(0);
}

/// How much of a machine's pose its layer shows, 0 … 1.
template <class T>
TimeJet<T> shown(const GraphMachineState<T>& machine);

/// The clip that a state's `remaining` is about, −1 where there is none: the first below it.
template <class T>
int leading_clip(const Graph& graph, GraphBlock<T>& block, int node);

/// Does a transition's condition hold?
template <class T>
bool holds(const Graph& graph, GraphBlock<T>& block, const GraphMachineState<T>& machine, int node,
           const GraphTransition& transition);

#define SINEW_GRAPH_WALK_INSTANCES(prefix, T)                                                    \
  prefix template void enter_node<T>(const Graph&, GraphBlock<T>&, int, double);                 \
  prefix template TimeJet<double> clip_speed<T>(const Graph&, GraphBlock<T>&, const GraphNode&); \
  prefix template ClipTime clip_time<T>(const Graph&, GraphBlock<T>&, int);                      \
  prefix template TimeJet<T> shown<T>(const GraphMachineState<T>&);                              \
  prefix template int leading_clip<T>(const Graph&, GraphBlock<T>&, int);                        \
  prefix template bool holds<T>(const Graph&, GraphBlock<T>&, const GraphMachineState<T>&, int,  \
                                const GraphTransition&);
SINEW_GRAPH_WALK_INSTANCES(extern, float)
SINEW_GRAPH_WALK_INSTANCES(extern, double)

}  // namespace sinew
