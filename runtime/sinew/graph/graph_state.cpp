#include "sinew/graph/graph_state.h"

#include <cmath>
#include <cstring>

#include "sinew/graph/graph_finish.h"
#include "sinew/graph/graph_walk.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kMostValue = 1e6;  ///< of a parameter
constexpr double kElsewhere = 1;    ///< m, beyond which feet are not where they were

}  // namespace

template <class T>
Status check_block(const Graph* graph, std::span<std::byte> state, bool begun) {
  if (!graph || graph->definition().nodes.empty()) return Status::error(Code::kInvalidArgument, "no graph");
  if (state.size() != graph->state_bytes<T>())
    return Status::error(Code::kInvalidArgument, "state of a graph has another size");
  if (reinterpret_cast<std::uintptr_t>(state.data()) % 16 != 0)
    return Status::error(Code::kInvalidArgument, "state of a graph does not begin at a multiple of 16");
  if (begun && GraphBlock<T>(*graph, state).header().hash != graph->hash())
    return Status::error(Code::kInvalidArgument, "state belongs to another graph, or was not started");
  return {};
}

template <class T>
Status start_graph(const Graph& graph, std::span<std::byte> state) {
  if (Status status = check_block<T>(&graph, state, false); !status) return status;
  std::memset(state.data(), 0, state.size());
  GraphBlock<T> block(graph, state);
  block.header().hash = graph.hash();
  const auto& parameters = graph.definition().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    GraphParameterState<T>& p = block.parameter(static_cast<int>(k));
    p.goal = parameters[k].type == ParameterType::kTrigger ? T(0) : T(parameters[k].value);
    p.x = TimeJet<T>(p.goal);
  }
  if (graph.feet().node >= 0) begin_feet(block.feet());
  for (std::size_t k = 0; k < graph.looks().size(); ++k) begin_look(block.look(static_cast<int>(k)));
  enter_node(graph, block, graph.root(), 0);
  return {};
}

template <class T>
bool GraphParameters<T>::is(int parameter, bool trigger) const {
  const auto& all = graph_.definition().parameters;
  return parameter >= 0 && std::size_t(parameter) < all.size() &&
         (all[std::size_t(parameter)].type == ParameterType::kTrigger) == trigger;
}

template <class T>
bool GraphParameters<T>::machine(int node) const {
  const auto& nodes = graph_.definition().nodes;
  return node >= 0 && std::size_t(node) < nodes.size() && nodes[std::size_t(node)].type == NodeType::kMachine;
}

template <class T>
Status GraphParameters<T>::set(int parameter, T value) {
  if (!is(parameter, false))
    return Status::error(Code::kInvalidArgument, "no float or bool of this number", parameter);
  if (!std::isfinite(value)) return Status::error(Code::kNotFinite, "parameter is not finite", parameter);
  if (std::abs(value) > T(kMostValue))
    return Status::error(Code::kOutOfRange, "parameter is absurd", parameter);
  block_.parameter(parameter).goal = value;
  return {};
}

template <class T>
Status GraphParameters<T>::trigger(int parameter) {
  if (!is(parameter, true))
    return Status::error(Code::kInvalidArgument, "no trigger of this number", parameter);
  // Waits for the next update in any case, and its buffer longer.
  block_.parameter(parameter).goal =
      T(graph_.definition().parameters[std::size_t(parameter)].buffer) + T(1e-6);
  return {};
}

template <class T>
T GraphParameters<T>::goal(int parameter) {
  return is(parameter, false) || is(parameter, true) ? block_.parameter(parameter).goal : T(0);
}

template <class T>
TimeJet<T> GraphParameters<T>::filtered(int parameter) {
  return is(parameter, false) ? block_.parameter(parameter).x : TimeJet<T>(T(0));
}

template <class T>
int GraphParameters<T>::state(int node) {
  return machine(node) ? block_.machine(graph_.slot(node)).state : -1;
}

template <class T>
double GraphParameters<T>::seconds_in_state(int node) {
  return machine(node) ? block_.machine(graph_.slot(node)).time : 0;
}

template <class T>
bool GraphParameters<T>::fading(int node) {
  return machine(node) && block_.machine(graph_.slot(node)).transition >= 0;
}

template <class T>
Vec3<double> GraphParameters<T>::place() {
  return {block_.header().place[0], block_.header().place[1], 0};
}

template <class T>
double GraphParameters<T>::heading() {
  return block_.header().heading;
}

template <class T>
void GraphParameters<T>::put(const Vec3<double>& place, double heading) {
  const double apart =
      portable::hypot(place.x() - block_.header().place[0], place.y() - block_.header().place[1]);
  if (graph_.feet().node >= 0 && apart > kElsewhere) begin_feet(block_.feet());
  block_.header().place[0] = place.x();
  block_.header().place[1] = place.y();
  block_.header().heading = heading;
}

template <class T>
TravelVelocity<T> GraphParameters<T>::travel() {
  return block_.header().travel;
}

SINEW_GRAPH_STATE_INSTANCES(, float)
SINEW_GRAPH_STATE_INSTANCES(, double)

}  // namespace sinew
