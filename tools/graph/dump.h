// What a graph's recorder kept, as a file and as JSON.
#pragma once

#include <span>
#include <string>

#include "graph/located_json.h"
#include "sinew/graph/graph.h"

namespace sinew::graph_tools {

/// A recorder's buffer with a digest that tells damage.
std::string recording_file(std::span<const std::byte> recording);

/// Plays each frame of a file again: {frame, h, same, rays, before, after, events}, the oldest first; `same`:
/// to the bit, `before` and `after`: describe_state(). What is wrong with the file, or empty.
std::string dump_recording(const Graph& graph, const std::string& file, Json& frames);

}  // namespace sinew::graph_tools
