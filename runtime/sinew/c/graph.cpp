// Graphs of the C interface.
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "sinew/c/call.h"
#include "sinew/c/layout.h"
#include "sinew/graph/graph_file.h"
#include "sinew/io/mapped_file.h"

namespace sinew::c {
namespace {

static_assert(int(ParameterType::kFloat) == SINEW_PARAMETER_FLOAT &&
              int(ParameterType::kBool) == SINEW_PARAMETER_BOOL &&
              int(ParameterType::kTrigger) == SINEW_PARAMETER_TRIGGER);
static_assert(int(NodeType::kClip) == SINEW_NODE_CLIP && int(NodeType::kBlend) == SINEW_NODE_BLEND &&
              int(NodeType::kLayers) == SINEW_NODE_LAYERS && int(NodeType::kMachine) == SINEW_NODE_MACHINE &&
              int(NodeType::kEmpty) == SINEW_NODE_EMPTY && int(NodeType::kPhysical) == SINEW_NODE_PHYSICAL &&
              int(NodeType::kMirror) == SINEW_NODE_MIRROR && int(NodeType::kTravel) == SINEW_NODE_TRAVEL &&
              int(NodeType::kFeet) == SINEW_NODE_FEET && int(NodeType::kLook) == SINEW_NODE_LOOK);
constexpr const char* kNoNode = "the graph has no such node";

std::shared_ptr<const BoundGraph> bind(const std::shared_ptr<const Asset>& asset,
                                       std::span<const std::uint8_t> bytes, Status& status) {
  GraphDefinition definition;
  if (status = read_graph(bytes, definition); !status) return {};
  auto bound = std::make_shared<BoundGraph>();
  bound->asset = asset;
  if (status = Graph::bind(definition, *asset, bound->graph); !status) return {};
  for (const GraphNode& node : definition.nodes) {
    bound->feels |= node.type == NodeType::kPhysical;
    bound->spends |= std::any_of(node.transitions.begin(), node.transitions.end(),
                                 [](const GraphTransition& t) { return t.budget > 0; });
  }
  return bound;
}

sinew_status make_graph(sinew_asset asset, std::span<const std::uint8_t> bytes, sinew_graph* out) noexcept {
  return with_shared_asset(asset, [&](const std::shared_ptr<const Asset>& clips) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Status status;
    auto owned = std::make_unique<OwnedGraph>(OwnedGraph{bind(clips, bytes, status)});
    if (!status) return answer(status);
    const sinew_graph handle = make_handle(Kind::kGraph, owned.get());
    if (handle == 0) return fail(SINEW_OUT_OF_RANGE, kTooMany);
    static_cast<void>(owned.release());  // the handle's now
    *out = handle;
    return sinew_status(SINEW_OK);
  });
}

/// act(const GraphDefinition&) of a graph.
template <class Act>
sinew_status with_definition(sinew_graph handle, Act&& act) noexcept {
  return with_graph(
      handle, [&](const std::shared_ptr<const BoundGraph>& bound) { return act(bound->graph.definition()); });
}

template <class Things>
sinew_status find_in(const Things& things, const char* name, int32_t* out) noexcept {
  if (!name || !out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  const int index = find_named(things, name);
  if (index < 0) return fail(SINEW_NOT_FOUND, kNoName);
  *out = index;
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_graph_load(const char* path, sinew_asset asset, sinew_graph* out) {
  if (!path) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!find_object(asset, Kind::kAsset)) return refuse(asset, Kind::kAsset);
  return caught([&] {
    MappedFile file;
    const Status status = file.open(path);
    return status ? make_graph(asset, file.bytes(), out) : answer(status);
  });
}

sinew_status sinew_graph_read(const void* bytes, size_t size, sinew_asset asset, sinew_graph* out) {
  if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return make_graph(asset, {static_cast<const std::uint8_t*>(bytes), size}, out);
}

sinew_status sinew_graph_destroy(sinew_graph graph) {
  const std::unique_ptr<OwnedGraph> found(static_cast<OwnedGraph*>(retire_handle(graph, Kind::kGraph)));
  return found ? sinew_status(SINEW_OK) : refuse(graph, Kind::kGraph);
}

sinew_status sinew_graph_get_info(sinew_graph graph, sinew_graph_info* out) {
  return with_graph(graph, [&](const std::shared_ptr<const BoundGraph>& bound) {
    return fill_sized(out, [&](sinew_graph_info& info) {
      const Graph& g = bound->graph;
      info.joints = g.joint_count();
      info.parameters = static_cast<int32_t>(g.definition().parameters.size());
      info.nodes = static_cast<int32_t>(g.definition().nodes.size());
      info.curves = g.curve_count();
      info.state_bytes = sizeof(SavedBlock) + g.state_bytes<float>();
    });
  });
}

sinew_status sinew_graph_get_parameter(sinew_graph graph, int32_t parameter, sinew_parameter_info* out) {
  return with_definition(graph, [&](const GraphDefinition& d) {
    if (!has(d.parameters, parameter)) return fail(SINEW_INVALID_ARGUMENT, kNoParameter, parameter);
    return fill_sized(out, [&](sinew_parameter_info& info) {
      const GraphParameter& p = d.parameters[std::size_t(parameter)];
      info.type = static_cast<sinew_parameter_type>(p.type);
      info.name = p.name.c_str();
      info.value = p.value;
      info.half_life = p.half_life;
      info.buffer = p.buffer;
    });
  });
}

sinew_status sinew_graph_find_parameter(sinew_graph graph, const char* name, int32_t* out) {
  return with_definition(graph, [&](const GraphDefinition& d) { return find_in(d.parameters, name, out); });
}

sinew_status sinew_graph_get_node(sinew_graph graph, int32_t node, sinew_node_info* out) {
  return with_definition(graph, [&](const GraphDefinition& d) {
    if (!has(d.nodes, node)) return fail(SINEW_INVALID_ARGUMENT, kNoNode, node);
    return fill_sized(out, [&](sinew_node_info& info) {
      const GraphNode& n = d.nodes[std::size_t(node)];
      info.type = static_cast<sinew_node_type>(n.type);
      info.name = n.name.c_str();
      info.states = static_cast<int32_t>(n.states.size());
      info.start = n.start;
    });
  });
}

sinew_status sinew_graph_find_node(sinew_graph graph, const char* name, int32_t* out) {
  return with_definition(graph, [&](const GraphDefinition& d) { return find_in(d.nodes, name, out); });
}

sinew_status sinew_graph_get_state(sinew_graph graph, int32_t machine, int32_t state, sinew_state_info* out) {
  return with_definition(graph, [&](const GraphDefinition& d) {
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    if (!has(d.nodes, machine) || d.nodes[std::size_t(machine)].type != NodeType::kMachine)
      return fail(SINEW_INVALID_ARGUMENT, kNoMachine, machine);
    const std::vector<GraphState>& states = d.nodes[std::size_t(machine)].states;
    if (!has(states, state)) return fail(SINEW_INVALID_ARGUMENT, "the machine has no such state", state);
    return fill_sized(out, [&](sinew_state_info& info) {
      info.node = states[std::size_t(state)].node;
      info.name = states[std::size_t(state)].name.c_str();
    });
  });
}
