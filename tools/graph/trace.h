// Plays a graph with given inputs and writes what happens.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "graph/located_json.h"
#include "sinew/graph/graph.h"

namespace sinew::graph_tools {

/// What a game would set, and when.
struct InputScript {
  struct Input {
    double time = 0;
    int parameter = 0;
    float value = 0;
  };
  std::vector<Input> inputs;  ///< by time

  /// [[seconds, "parameter", number or true or false], [seconds, "trigger"], …]. What is wrong, or empty.
  std::string read(const std::string& text, const std::string& path, const GraphDefinition& graph);
  /// Those in [from, to).
  void apply(const Graph& graph, std::span<std::byte> state, double from, double to) const;
};

struct TraceOptions {
  double seconds = 10, rate = 60;
  int joint = -1;  ///< whose acceleration is told and explained; −1: of each frame the one that has most
  GraphMemory* recording = nullptr;  ///< of the last frames, as many as it has room for
};

/// A row of CSV per frame: time, states of all machines, place and heading, the joint, its angular
/// acceleration (rad/s²), the nodes that this comes from with their shares (of the joint that is asked for),
/// events. `end`: describe_state() of the last one. Physical poses are the graph's own.
Status trace_graph(const Graph& graph, const Asset& asset, const InputScript& inputs,
                   const TraceOptions& options, std::ostream& rows, Json& end);

}  // namespace sinew::graph_tools
