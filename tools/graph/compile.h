// Graphs as people write them (JSON, runtime/sinew/graph/README.md) → GraphDefinition.
#pragma once

#include <string>
#include <vector>

#include "graph/located_json.h"
#include "sinew/graph/graph_definition.h"
#include "sinew/io/asset.h"

namespace sinew::graph_tools {

struct Compiled {
  GraphDefinition graph;
  std::vector<std::string> warnings;  ///< "hero.graph.json:12: …"
  std::vector<int> lines;             ///< [node] where it stands
  std::string error;                  ///< the first fault, likewise, or empty
};

/// `path` is what messages begin with. Faults: unknown names, wrong types, cycles, transitions that can never
/// fire.
Compiled compile_graph(const std::string& text, const std::string& path);

/// As Graph::bind, with the fault as "hero.graph.json:12: main/move: the asset has no clip 'wolk'", or empty.
std::string bind_fault(const Compiled& compiled, const std::string& path, const Asset& asset);

}  // namespace sinew::graph_tools
