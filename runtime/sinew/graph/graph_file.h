// Graph files (.sgraph): FlatBuffers, verified before anything is read, then checked by validate().
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/graph/graph_definition.h"

namespace sinew {

/// Reads a file image. On error `out` is left as it was. A broken file gives an error, never a crash.
Status read_graph(std::span<const std::uint8_t> bytes, GraphDefinition& out);

/// File image of a valid graph; the same graph always gives the same bytes.
std::vector<std::uint8_t> write_graph(const GraphDefinition& graph);

}  // namespace sinew
