#include "graph/certificate.h"

#include <set>

namespace sinew::graph_tools {
namespace {

constexpr int kNotThePose = -1, kNotTheVelocity = 0, kNotTheAcceleration = 1;  ///< what still is

class Certificate {
 public:
  explicit Certificate(const GraphDefinition& graph) : graph_(graph) {}

  std::vector<SmoothnessLoss> losses() {
    for (int k = 0; k < static_cast<int>(graph_.nodes.size()); ++k) {
      const GraphNode& node = graph_.nodes[std::size_t(k)];
      if (node.type == NodeType::kClip && node.speed.parameter >= 0)
        unfiltered(k, node.speed.parameter, kNotTheVelocity, "is the speed of clip '" + node.clip + "'");
      if (node.type == NodeType::kBlend)
        for (const int parameter : node.parameters)
          if (parameter >= 0) unfiltered(k, parameter, kNotThePose, "moves a blend");
      for (const GraphLayer& layer : node.layers)
        if (layer.weight.parameter >= 0)
          unfiltered(k, layer.weight.parameter, kNotThePose, "is the weight of a layer");
      if (node.type == NodeType::kPhysical)
        lose(k, kNotThePose, "the physical pose is as the body is thrown about");
      if (node.type == NodeType::kMachine) machine(k, node);
      if (node.type == NodeType::kTravel) travel(k, node.travel);
      if (node.type == NodeType::kFeet) feet(k, node.feet);
      if (node.type == NodeType::kLook) look(k, node.look);
    }
    return std::move(losses_);
  }

 private:
  void lose(int node, int order, const std::string& reason) { losses_.push_back({node, order, reason}); }
  void unfiltered(int node, int parameter, int order, const std::string& what) {
    const GraphParameter& p = graph_.parameters[std::size_t(parameter)];
    if (p.half_life > 0) return;
    lose(node, order, "parameter '" + p.name + "' is not filtered and " + what);
  }
  void weight(int node, const GraphValue& v, const std::string& what) {
    if (v.parameter >= 0) unfiltered(node, v.parameter, kNotThePose, what);
  }
  void travel(int index, const GraphTravel& in) {
    for (const int parameter : in.parameters)
      if (parameter >= 0) unfiltered(index, parameter, kNotTheVelocity, "is a velocity over the ground");
    if (in.weight.parameter >= 0)
      unfiltered(index, in.weight.parameter, kNotTheVelocity, "is the weight of such a velocity");
  }
  void feet(int index, const GraphFeet& in) {
    weight(index, in.weight, "is the weight of feet");
    if (in.level >= 0) unfiltered(index, in.level, kNotThePose, "is the height of the ground");
    if (in.locks && in.settings.lock_time <= 0) lose(index, kNotThePose, "feet lock in no time");
    if (in.locks && in.settings.release_time <= 0) lose(index, kNotThePose, "feet are let go in no time");
  }
  void look(int index, const GraphLook& in) {
    weight(index, in.weight, "is the weight of a look");
    if (in.settings.half_life > 0) return;  // which filters the angles itself
    for (const int parameter : in.target)
      unfiltered(index, parameter, kNotThePose, "is a target's place, and the look has no half_life");
  }
  void machine(int index, const GraphNode& node) {
    bool offsets = false;
    for (const GraphTransition& t : node.transitions) {
      offsets |= t.kind == TransitionKind::kInertial;
      if (t.kind == TransitionKind::kSmoothstep)
        lose(index, kNotTheAcceleration,
             "the transition to '" + node.states[std::size_t(t.to)].name + "' fades by a smoothstep");
      if (t.kind != TransitionKind::kCut && t.duration > 0) continue;
      const std::string from = t.from < 0 ? "any state" : "'" + node.states[std::size_t(t.from)].name + "'";
      lose(index, kNotThePose,
           "the transition from " + from + " to '" + node.states[std::size_t(t.to)].name + "' " +
               (t.kind == TransitionKind::kCut ? "cuts" : "takes no time"));
    }
    if (!offsets) return;
    // At a change the phase of a group goes on at another rate. The machine's own fading hides that of what
    // is in it only.
    std::set<int> inside, outside;
    std::vector<char> below(graph_.nodes.size(), 0);
    below[std::size_t(index)] = 1;
    for (std::size_t k = std::size_t(index) + 1; k-- > 0;)
      if (below[k])
        for (const int child : graph_.nodes[k].children) below[std::size_t(child)] = 1;
    for (std::size_t k = 0; k < graph_.nodes.size(); ++k)
      if (graph_.nodes[k].group >= 0) (below[k] ? inside : outside).insert(graph_.nodes[k].group);
    for (const int group : inside)
      if (outside.count(group))
        lose(index, kNotTheVelocity,
             "clips outside are synchronised as '" + graph_.groups[std::size_t(group)] +
                 "' too, whose pace jumps when this machine changes its state");
  }

  const GraphDefinition& graph_;
  std::vector<SmoothnessLoss> losses_;
};

}  // namespace

std::vector<SmoothnessLoss> smoothness_losses(const GraphDefinition& graph) {
  return Certificate(graph).losses();
}

}  // namespace sinew::graph_tools
