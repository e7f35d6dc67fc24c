#include "sinew/graph/graph_walk.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/quintic_offset.h"

namespace sinew {
namespace {

template <class T>
void enter_machine(const Graph& graph, GraphBlock<T>& block, const GraphNode& node, int slot) {
  GraphMachineState<T>& m = block.machine(slot);
  m.time = 0;
  m.state = m.posed = static_cast<std::int16_t>(node.start);
  m.source = m.transition = -1;
  m.fade = GraphFade::kNone;
  m.elapsed = m.duration = m.shown_elapsed = m.shown_duration = T(0);
  const int pose = node.states[std::size_t(node.start)].node;
  m.shown = graph.node(pose).type == NodeType::kEmpty ? T(0) : T(1);
}

template <class T>
void enter_clip(const Graph& graph, GraphBlock<T>& block, const GraphNode& node, int slot, double entry) {
  const TimeJet<double> speed = clip_speed(graph, block, node);
  const int time = graph.clips()[std::size_t(slot)].time;
  if (time >= 0) block.time(time) = {entry, speed.value, speed.rate};
  block.set_fresh(slot, true);
  if (node.group < 0) return;
  GraphGroupState& group = block.group(node.group);
  if (group.active == 0) group.phase = TimeJet<double>(0.0);
  group.active = 1;
}

}  // namespace

template <class T>
TimeJet<double> clip_speed(const Graph&, GraphBlock<T>& block, const GraphNode& node) {
  if (node.speed.parameter < 0) return {double(node.speed.constant), 0, 0};
  const TimeJet<T>& x = block.parameter(node.speed.parameter).x;
  return {double(x.value), double(x.rate), double(x.acceleration)};
}

template <class T>
void enter_node(const Graph& graph, GraphBlock<T>& block, int index, double entry) {
  const GraphNode& node = graph.node(index);
  if (node.type == NodeType::kClip) return enter_clip(graph, block, node, graph.slot(index), entry);
  if (node.type == NodeType::kMachine) {
    enter_machine(graph, block, node, graph.slot(index));
    return enter_node(graph, block, node.states[std::size_t(node.start)].node, entry);
  }
  for (const int child : node.children) enter_node(graph, block, child, entry);
}

ClipTime played_time(const Clip& clip, const TimeJet<double>& played) {
  const double duration = double(clip.duration), soft = std::min(double(Graph::kSoftEnd), duration / 2);
  if (clip.loops || played.value <= duration - soft) return played;
  if (!(soft > 0) || played.value >= duration + soft) return {duration, 0, 0};
  // Its rate falls from 1 to 0 over twice `soft` by the quintic step: τ = begin + 2·soft·(s − (s⁶ − 3s⁵ +
  // 2½s⁴)).
  const double width = 2 * soft;
  const TimeJet<double> s = (played - TimeJet<double>(duration - soft)) / TimeJet<double>(width);
  const TimeJet<double> s4 = s * s * s * s;
  return TimeJet<double>(duration - soft) + width * (s - s4 * (s * s - 3.0 * s + TimeJet<double>(2.5)));
}

template <class T>
ClipTime clip_time(const Graph& graph, GraphBlock<T>& block, int clip) {
  const Graph::BoundClip& bound = graph.clips()[std::size_t(clip)];
  const int group = graph.node(bound.node).group;
  return group >= 0 ? bound.map.at(block.group(group).phase)
                    : played_time(*bound.clip, block.time(bound.time));
}

template <class T>
TimeJet<T> shown(const GraphMachineState<T>& m) {
  return soft_step(TimeJet<T>(m.shown) +
                   QuinticOffset<T>::at(m.shown_elapsed, m.shown_duration)(m.shown_from));
}

template <class T>
int leading_clip(const Graph& graph, GraphBlock<T>& block, int index) {
  while (true) {
    const GraphNode& node = graph.node(index);
    if (node.type == NodeType::kClip) return graph.slot(index);
    if (node.children.empty()) return -1;
    index = node.type == NodeType::kMachine
                ? node.states[std::size_t(block.machine(graph.slot(index)).posed)].node
                : node.children.front();
  }
}

namespace {

template <class T>
float remaining(const Graph& graph, GraphBlock<T>& block, int node) {
  const int clip = leading_clip(graph, block, node);
  if (clip < 0) return 0;
  const Graph::BoundClip& bound = graph.clips()[std::size_t(clip)];
  const double duration = double(bound.clip->duration);
  TimeJet<double> time = clip_time(graph, block, clip);
  if (bound.clip->loops) {
    time.value -= duration * std::floor(time.value / duration);
  } else {
    time = block.time(bound.time);
  }
  const double left = time.rate >= 0 ? std::max(0.0, duration - time.value) : std::max(0.0, time.value);
  return static_cast<float>(left / std::max(1e-6, std::abs(time.rate)));
}

template <class T>
float pushed(const Graph& graph, GraphBlock<T>& block, const GraphMachineState<T>& machine, int node,
             const ConditionStep& step) {
  switch (step.code) {
    case ConditionCode::kParameter: {
      const float goal = static_cast<float>(block.parameter(step.index).goal);
      const bool trigger = graph.definition().parameters[step.index].type == ParameterType::kTrigger;
      return trigger ? float(goal > 0) : goal;
    }
    case ConditionCode::kTime:
      return static_cast<float>(machine.time);
    case ConditionCode::kRemaining:
      return remaining(graph, block, graph.node(node).states[std::size_t(machine.posed)].node);
    case ConditionCode::kPhase: {
      const double phase = block.group(step.index).phase.value;
      return static_cast<float>(phase - std::floor(phase));
    }
    case ConditionCode::kEvent:
      return float((block.header().events >> step.index) & 1u);
    case ConditionCode::kFading:
      return float(machine.transition >= 0);
    default:
      return step.value;
  }
}

float combined(ConditionCode code, float a, float b) {
  switch (code) {
    case ConditionCode::kLess:
      return float(a < b);
    case ConditionCode::kLessEqual:
      return float(a <= b);
    case ConditionCode::kEqual:
      return float(a == b);
    case ConditionCode::kAnd:
      return float(a != 0 && b != 0);
    default:
      return float(a != 0 || b != 0);
  }
}

}  // namespace

template <class T>
bool holds(const Graph& graph, GraphBlock<T>& block, const GraphMachineState<T>& machine, int node,
           const GraphTransition& transition) {
  if (transition.condition.empty()) return true;
  float stack[GraphDefinition::kDeepestCondition + 1] = {};
  int height = 0;
  for (const ConditionStep& step : transition.condition) {
    if (step.code < ConditionCode::kLess) {
      stack[height++] = pushed(graph, block, machine, node, step);
    } else if (step.code == ConditionCode::kNot) {
      stack[height - 1] = float(stack[height - 1] == 0);
    } else {
      --height;
      stack[height - 1] = combined(step.code, stack[height - 1], stack[height]);
    }
  }
  return stack[0] != 0;
}

SINEW_GRAPH_WALK_INSTANCES(, float)
SINEW_GRAPH_WALK_INSTANCES(, double)

}  // namespace sinew
