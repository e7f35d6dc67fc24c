#include "sinew/graph/graph_definition.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/blend_space.h"
#include "sinew/animation/foot_placement_job.h"

namespace sinew {
namespace {

constexpr float kLongest = 3600;  ///< s, of any duration

Status bad(const char* reason, int index) {
  return Status::error(Code::kInvalidArgument, reason, index);
}

bool within(float v, float low, float high) {
  return v >= low && v <= high;  // false for NaN
}

class Check {
 public:
  explicit Check(const GraphDefinition& graph) : graph_(graph), depth_(graph.nodes.size(), 1) {}

  Status parameters() const {
    for (std::size_t k = 0; k < graph_.parameters.size(); ++k) {
      const GraphParameter& p = graph_.parameters[k];
      const int index = static_cast<int>(k);
      if (!std::isfinite(p.value)) return bad("value of a parameter is not finite", index);
      if (!within(p.half_life, 0, kLongest) || (p.half_life > 0 && p.half_life < 1e-3f))
        return bad("half-life of a parameter is negative, absurd, or below a millisecond", index);
      if (!within(p.buffer, 0, kLongest)) return bad("buffer of a trigger is negative or absurd", index);
    }
    return {};
  }
  Status node(int index) {
    const GraphNode& node = graph_.nodes[std::size_t(index)];
    for (const int child : node.children) {
      if (child < 0 || child >= index) return bad("child does not come before its parent", index);
      depth_[std::size_t(index)] = std::max(depth_[std::size_t(index)], depth_[std::size_t(child)] + 1);
    }
    if (depth_[std::size_t(index)] > GraphDefinition::kDeepest)
      return bad("nodes are nested too deep", index);
    switch (node.type) {
      case NodeType::kClip:
        return clip(node, index);
      case NodeType::kBlend:
        return blend(node, index);
      case NodeType::kLayers:
        return layers(node, index);
      case NodeType::kMachine:
        return machine(node, index);
      case NodeType::kMirror:
        return one_child(node, index);
      case NodeType::kTravel:
        return travel(node, index);
      case NodeType::kFeet:
        return feet(node, index);
      case NodeType::kLook:
        return look(node, index);
      case NodeType::kEmpty:
      case NodeType::kPhysical:
        return node.children.empty() ? Status{} : bad("a pose has children", index);
    }
    return bad("unknown type of node", index);
  }
  Status parents() const {
    std::vector<int> parents(graph_.nodes.size(), 0);
    int feet = 0;
    for (const GraphNode& node : graph_.nodes)
      for (std::size_t k = 0; k < node.children.size(); ++k) {
        const int child = node.children[k];
        if (++parents[std::size_t(child)] > 1) return bad("node has two parents", child);
        if (has_empty_state(graph_, child) && (node.type != NodeType::kLayers || k == 0))
          return bad("a machine with an empty state is no layer", child);
      }
    const int root = static_cast<int>(graph_.nodes.size()) - 1;
    for (int k = 0; k <= root; ++k) {
      feet += graph_.nodes[std::size_t(k)].type == NodeType::kFeet;
      if (finishes(k) && k != root && !below_finisher(k))
        return bad("feet and looks are of the whole pose: nothing else may be above them", k);
      if (feet > 1) return bad("a graph has one pair of feet", k);
    }
    return has_empty_state(graph_, root) ? bad("a machine with an empty state is no layer", root) : Status{};
  }

 private:
  bool is_float(int parameter) const {
    return parameter >= 0 && std::size_t(parameter) < graph_.parameters.size() &&
           graph_.parameters[std::size_t(parameter)].type == ParameterType::kFloat;
  }
  bool fine(const GraphValue& v) const {
    return std::isfinite(v.constant) && (v.parameter == -1 || is_float(v.parameter));
  }
  bool finishes(int node) const {
    const NodeType type = graph_.nodes[std::size_t(node)].type;
    return type == NodeType::kFeet || type == NodeType::kLook;
  }
  bool below_finisher(int node) const {
    for (int k = node + 1; k < static_cast<int>(graph_.nodes.size()); ++k)
      if (finishes(k) && graph_.nodes[std::size_t(k)].children.front() == node) return true;
    return false;
  }
  bool is_weight(const GraphValue& v) const {
    return fine(v) && (v.parameter >= 0 || within(v.constant, 0, 1));
  }
  Status one_child(const GraphNode& node, int index) const {
    return node.children.size() == 1 && !empty(node.children[0])
               ? Status{}
               : bad("a node has another number of children than one, or an empty one", index);
  }
  Status travel(const GraphNode& node, int index) const {
    if (Status status = one_child(node, index); !status) return status;
    for (const int parameter : node.travel.parameters)
      if (parameter != -1 && !is_float(parameter)) return bad("travel by what is no float parameter", index);
    return is_weight(node.travel.weight) ? Status{} : bad("weight of a travel is no weight", index);
  }
  Status feet(const GraphNode& node, int index) const {
    if (Status status = one_child(node, index); !status) return status;
    const GraphFeet& feet = node.feet;
    if (!is_weight(feet.weight)) return bad("weight of feet is no weight", index);
    if (feet.level != -1 && !is_float(feet.level)) return bad("level is no float parameter", index);
    if (!within(feet.lift, 1e-3f, kLongest)) return bad("lift is not a millisecond or more", index);
    const int parents[] = {-1};
    JointJet<float> jets[1];
    FootPlacementJob<float> job;
    job.parents = parents;
    job.jets = jets;
    job.settings = feet.settings;
    job.reach = feet.reach;
    job.follow = feet.follow;
    job.rise = feet.rise;
    job.deepest = feet.deepest;
    const Status status = job.Validate();
    return status ? Status{} : bad(status.reason, index);
  }
  Status look(const GraphNode& node, int index) const {
    if (Status status = one_child(node, index); !status) return status;
    const GraphLook& look = node.look;
    if (!is_weight(look.weight)) return bad("weight of a look is no weight", index);
    for (const int parameter : look.target)
      if (!is_float(parameter)) return bad("target of a look is not three float parameters", index);
    if (look.joints.size() != look.shares.size() || look.joints.size() > std::size_t(LookChain<float>::kMost))
      return bad("joints of a look and their shares differ in number, or are more than eight", index);
    for (const float share : look.shares)
      if (!within(share, 1e-3f, 1e3f)) return bad("share of a look is not above 0", index);
    const int parents[] = {-1};
    JointJet<float> jets[1];
    LookChain<float> chain;
    chain.count = 1;
    chain.shares[0] = 1;
    LookState<float> state;
    LookAtJob<float> job;
    job.parents = parents;
    job.jets = jets;
    job.chain = &chain;
    job.state = &state;
    job.settings = look.settings;
    const Status status = job.Validate();
    return status ? Status{} : bad(status.reason, index);
  }
  bool empty(int node) const { return graph_.nodes[std::size_t(node)].type == NodeType::kEmpty; }

  Status clip(const GraphNode& node, int index) const {
    if (node.clip.empty()) return bad("clip has no name", index);
    if (!node.children.empty()) return bad("a clip has children", index);
    if (!fine(node.speed)) return bad("speed is not a number or a float parameter", index);
    if (node.group < -1 || node.group >= static_cast<int>(graph_.groups.size()))
      return bad("clip belongs to a group that does not exist", index);
    if (node.group >= 0 && (node.speed.parameter >= 0 || !within(node.speed.constant, 0.02f, 50)))
      return bad("speed of a synchronised clip is not a number from 0.02 to 50", index);
    return {};
  }
  Status blend(const GraphNode& node, int index) const {
    const std::size_t dimensions = node.parameters[1] >= 0 ? 2 : 1;
    if (!is_float(node.parameters[0]) || (dimensions == 2 && !is_float(node.parameters[1])))
      return bad("blend has no float parameter", index);
    if (node.children.empty() || node.children.size() > std::size_t(BlendSpace::kMaxClips))
      return bad("blend has no children, or more than 16", index);
    if (node.points.size() != dimensions * node.children.size())
      return bad("children of a blend and their points differ in number", index);
    for (const float p : node.points)
      if (!std::isfinite(p)) return bad("point of a blend is not finite", index);
    for (const int child : node.children)
      if (empty(child)) return bad("a blend has an empty child", index);
    return {};
  }
  Status layers(const GraphNode& node, int index) const {
    if (node.children.empty() || node.layers.size() + 1 != node.children.size())
      return bad("layers and their nodes differ in number", index);
    for (const int child : node.children)
      if (empty(child)) return bad("a layer is empty itself", index);
    for (const GraphLayer& layer : node.layers) {
      if (!fine(layer.weight)) return bad("weight of a layer is not a number or a float parameter", index);
      if (layer.weight.parameter < 0 && !within(layer.weight.constant, 0, 1))
        return bad("weight of a layer is not within 0 and 1", index);
      if (!within(layer.reference_time, 0, kLongest)) return bad("time of a reference is absurd", index);
    }
    return {};
  }
  Status machine(const GraphNode& node, int index) const {
    const int states = static_cast<int>(node.states.size());
    if (states == 0 || states > 1000) return bad("machine has no states, or more than a thousand", index);
    if (node.start < 0 || node.start >= states || node.states[std::size_t(node.start)].node < 0)
      return bad("machine starts in no state that has a pose", index);
    for (const GraphState& state : node.states)
      if (state.node != -1 &&
          std::find(node.children.begin(), node.children.end(), state.node) == node.children.end())
        return bad("state plays what is no child of its machine", index);
    for (const GraphTransition& t : node.transitions)
      if (Status status = transition(node, t, index); !status) return status;
    return {};
  }
  Status transition(const GraphNode& node, const GraphTransition& t, int index) const {
    const int states = static_cast<int>(node.states.size());
    if (t.to < 0 || t.to >= states || t.from < GraphTransition::kAnyState || t.from >= states)
      return bad("transition between states that do not exist", index);
    if (!within(t.duration, 0, kLongest) || !within(t.budget, 0, 1000) || !within(t.entry, 0, kLongest))
      return bad("duration, budget or entry of a transition is negative or absurd", index);
    if (!within(t.share, 0.1f, 1))
      return bad("share of a transition's profile is not within 0.1 and 1", index);
    if (!t.profile.empty() && (t.budget > 0 || t.kind != TransitionKind::kInertial))
      return bad("only inertial transitions without a budget have a profile", index);
    for (const int state : t.interrupted_by)
      if (state < 0 || state >= states) return bad("transition is interrupted by no state", index);
    return condition(t.condition, index);
  }
  Status condition(const std::vector<ConditionStep>& steps, int index) const {
    int height = 0;
    for (const ConditionStep& step : steps) {
      const std::size_t most = step.code == ConditionCode::kParameter ? graph_.parameters.size()
                               : step.code == ConditionCode::kPhase   ? graph_.groups.size()
                               : step.code == ConditionCode::kEvent   ? graph_.events.size()
                                                                      : 1;
      if (step.index >= most) return bad("condition asks for what does not exist", index);
      if (!std::isfinite(step.value)) return bad("condition has a number that is not finite", index);
      const bool two = step.code >= ConditionCode::kLess && step.code <= ConditionCode::kOr;
      const bool one = step.code == ConditionCode::kNot;
      if (height < (two ? 2 : one ? 1 : 0)) return bad("condition takes more than it has", index);
      height += two ? -1 : one ? 0 : 1;
      if (height > GraphDefinition::kDeepestCondition) return bad("condition is nested too deep", index);
    }
    return height == 1 || steps.empty() ? Status{} : bad("condition is not one value", index);
  }

  const GraphDefinition& graph_;
  std::vector<int> depth_;
};

}  // namespace

int GraphDefinition::find_parameter(const std::string& wanted) const {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const GraphParameter& p) { return p.name == wanted; });
  return found == parameters.end() ? -1 : static_cast<int>(found - parameters.begin());
}

int physics_value(const std::string& name, std::size_t& mask) {
  mask = 0;
  const std::string of_mask = std::string(kPhysicsNames[kPhysicsLoad]) + ".";
  if (name.size() > of_mask.size() && name.compare(0, of_mask.size(), of_mask) == 0) {
    mask = of_mask.size();
    return kPhysicsLoad;
  }
  const auto found = std::find(std::begin(kPhysicsNames), std::end(kPhysicsNames), name);
  return found == std::end(kPhysicsNames) ? -1 : static_cast<int>(found - std::begin(kPhysicsNames));
}

bool has_empty_state(const GraphDefinition& graph, int node) {
  const std::vector<GraphState>& states = graph.nodes[std::size_t(node)].states;
  return std::any_of(states.begin(), states.end(), [&](const GraphState& state) {
    return state.node >= 0 && graph.nodes[std::size_t(state.node)].type == NodeType::kEmpty;
  });
}

Status validate(const GraphDefinition& graph) {
  if (graph.nodes.empty() || graph.nodes.size() > std::size_t(GraphDefinition::kMostNodes))
    return bad("graph has no nodes, or more than 4096", -1);
  if (graph.parameters.size() > std::size_t(GraphDefinition::kMostParameters) || graph.groups.size() > 256 ||
      graph.events.size() > std::size_t(GraphDefinition::kMostEvents))
    return bad("more than 256 parameters or groups, or 32 events", -1);
  if (graph.nodes.back().type == NodeType::kEmpty) return bad("graph has no pose", -1);
  Check check(graph);
  if (Status status = check.parameters(); !status) return status;
  for (std::size_t k = 0; k < graph.nodes.size(); ++k)
    if (Status status = check.node(static_cast<int>(k)); !status) return status;
  return check.parents();
}

}  // namespace sinew
