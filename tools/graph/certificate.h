// Does a graph keep accelerations continuous, and if not: where is that lost?
#pragma once

#include <string>
#include <vector>

#include "sinew/graph/graph_definition.h"

namespace sinew::graph_tools {

struct SmoothnessLoss {
  int node = 0;
  int order = -1;      ///< of the highest derivative that is still continuous: −1 none, not even the pose
  std::string reason;  ///< "state 'a' is cut to"
};

/// Every place at which a character's pose, velocity or acceleration may jump, in the order of nodes. None:
/// the graph is C² for whatever the game sets, its clips being C² within.
std::vector<SmoothnessLoss> smoothness_losses(const GraphDefinition& graph);

}  // namespace sinew::graph_tools
