// Graphs and characters in them, for people: a drawing, and what is going on as JSON.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "graph/located_json.h"
#include "sinew/graph/graph_state.h"

namespace sinew::graph_tools {

/// For Graphviz: machines as clusters of states, transitions with their conditions.
std::string graph_dot(const GraphDefinition& graph);

/// Parameters, groups and, from the root down, every node that plays: the machine's state, how long it is in
/// it, the transition that runs and how far, what each transition out of the state waits for, and clips with
/// their times.
Json describe_state(const Graph& graph, std::span<std::byte> state);

}  // namespace sinew::graph_tools
