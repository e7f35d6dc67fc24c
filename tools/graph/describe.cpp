#include "graph/describe.h"

#include "graph/condition.h"
#include "sinew/graph/graph_walk.h"

namespace sinew::graph_tools {
namespace {

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

class Dot {
 public:
  explicit Dot(const GraphDefinition& graph) : graph_(graph) {}

  std::string draw() {
    out_ =
        "digraph graph_of_clips {\n  compound=true;\n  node [shape=box, style=rounded, fontname=\"sans\"];\n"
        "  edge [fontname=\"sans\", fontsize=10];\n";
    node(static_cast<int>(graph_.nodes.size()) - 1, "", 1);
    return out_ + "}\n";
  }

 private:
  void line(int depth, const std::string& text) {
    out_ += std::string(std::size_t(2 * depth), ' ') + text + "\n";
  }
  static std::string id(int node) { return "n" + std::to_string(node); }
  std::string label(const GraphNode& n, const std::string& state) const {
    std::string text = state;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "\\n") + more; };
    if (n.type == NodeType::kClip && n.clip != state) add(n.clip);
    if (n.type == NodeType::kClip && n.group >= 0) add("in step: " + graph_.groups[std::size_t(n.group)]);
    if (n.type == NodeType::kBlend) {
      std::string by = graph_.parameters[std::size_t(n.parameters[0])].name;
      if (n.parameters[1] >= 0) by += ", " + graph_.parameters[std::size_t(n.parameters[1])].name;
      add("blend by " + by);
    }
    if (n.type == NodeType::kLayers) add("layers");
    if (n.type == NodeType::kEmpty) add("(nothing)");
    if (n.type == NodeType::kPhysical) add("(physical pose)");
    if (n.type == NodeType::kMirror) add("mirrored");
    if (n.type == NodeType::kTravel) add("travel by " + names(n.travel.parameters));
    if (n.type == NodeType::kFeet) add("feet on the ground");
    if (n.type == NodeType::kLook) add("look at " + names(n.look.target));
    return text;
  }
  std::string names(const int (&parameters)[3]) const {
    std::string text;
    for (const int k : parameters)
      if (k >= 0) text += (text.empty() ? "" : ", ") + graph_.parameters[std::size_t(k)].name;
    return text;
  }
  void node(int index, const std::string& state, int depth) {
    const GraphNode& n = graph_.nodes[std::size_t(index)];
    if (n.type == NodeType::kMachine) return machine(index, n, state, depth);
    line(depth, id(index) + " [label=" + in_quotes_label(label(n, state)) + "];");
    for (std::size_t k = 0; k < n.children.size(); ++k) {
      node(n.children[k], "", depth);
      std::string how;
      if (n.type == NodeType::kLayers) how = k == 0 ? "below" : n.layers[k - 1].mask;
      if (n.type == NodeType::kBlend) how = point(n, k);
      line(depth, id(index) + " -> " + id(anchor(n.children[k])) +
                      " [style=dashed, arrowhead=none, label=" + in_quotes(how) + "];");
    }
  }
  static std::string in_quotes_label(const std::string& text) {  // \n stays a line's end
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\\\"" : std::string(1, c);
    return out + "\"";
  }
  static std::string point(const GraphNode& n, std::size_t k) {
    const std::size_t dimensions = n.parameters[1] >= 0 ? 2 : 1;
    std::string text;
    for (std::size_t d = 0; d < dimensions; ++d)
      text += (d ? ", " : "") + Json(n.points[k * dimensions + d]).dump();
    return text;
  }
  /// A node that is drawn, for edges to a cluster.
  int anchor(int index) const {
    const GraphNode* n = &graph_.nodes[std::size_t(index)];
    while (n->type == NodeType::kMachine) {
      index = n->states[std::size_t(n->start)].node;
      n = &graph_.nodes[std::size_t(index)];
    }
    return index;
  }
  std::string state_id(int machine, int state) const {
    const int node = graph_.nodes[std::size_t(machine)].states[std::size_t(state)].node;
    return node < 0 ? "c" + std::to_string(machine) + "_" + std::to_string(state) : id(anchor(node));
  }
  void machine(int index, const GraphNode& n, const std::string& state, int depth) {
    line(depth, "subgraph cluster_" + std::to_string(index) + " {");
    line(depth + 1, "label=" + in_quotes(state.empty() ? n.name : state) + "; color=gray;");
    for (std::size_t k = 0; k < n.states.size(); ++k) {
      if (n.states[k].node < 0)
        line(depth + 1, state_id(index, static_cast<int>(k)) +
                            " [shape=diamond, label=" + in_quotes(n.states[k].name) + "];");
      else
        node(n.states[k].node, n.states[k].name, depth + 1);
    }
    const std::string any = "any" + std::to_string(index);
    for (const GraphTransition& t : n.transitions)
      if (t.from < 0) {
        line(depth + 1, any + " [shape=plaintext, label=\"any state\"];");
        break;
      }
    for (const GraphTransition& t : n.transitions)
      line(depth + 1, (t.from < 0 ? any : state_id(index, t.from)) + " -> " + state_id(index, t.to) +
                          " [label=" + in_quotes(condition_text(t.condition, graph_)) + "];");
    line(depth, "}");
  }

  const GraphDefinition& graph_;
  std::string out_;
};

class Description {
 public:
  Description(const Graph& graph, std::span<std::byte> state) : graph_(graph), block_(graph, state) {}

  Json run() {
    Json out;
    const GraphDefinition& definition = graph_.definition();
    for (std::size_t k = 0; k < definition.parameters.size(); ++k) {
      const GraphParameterState<float>& p = block_.parameter(static_cast<int>(k));
      Json& at = out["parameters"][definition.parameters[k].name];
      if (definition.parameters[k].type == ParameterType::kTrigger)
        at = {{"waits", p.goal}};
      else
        at = {{"goal", p.goal}, {"value", p.x.value}, {"rate", p.x.rate}, {"acceleration", p.x.acceleration}};
    }
    for (std::size_t k = 0; k < definition.groups.size(); ++k) {
      const GraphGroupState& group = block_.group(static_cast<int>(k));
      out["groups"][definition.groups[k]] = {{"phase", group.phase.value}, {"rate", group.phase.rate}};
    }
    const GraphHeader<float>& header = block_.header();
    out["place"] = {header.place[0], header.place[1]};
    out["heading"] = header.heading;
    out["plays"] = node(graph_.root());
    return out;
  }

 private:
  Json node(int index) {
    const GraphNode& n = graph_.node(index);
    Json out = {{"node", n.name}};
    if (n.type == NodeType::kClip) {
      const ClipTime time = clip_time(graph_, block_, graph_.slot(index));
      out.update({{"clip", n.clip}, {"time", time.value}, {"rate", time.rate}});
    } else if (n.type == NodeType::kMachine) {
      machine(index, n, out);
    } else {
      if (n.type == NodeType::kFeet) feet(out);
      for (const int child : n.children) out["children"].push_back(node(child));
    }
    return out;
  }
  void feet(Json& out) {
    const GraphFeetState<float>& feet = block_.feet();
    out["level"] = feet.level.x.value;
    for (const int k : {0, 1}) {
      const FootState<float>& leg = feet.legs[k];
      static constexpr const char* kHolds[] = {"free", "toe", "heel"};
      out["feet"].push_back({{"holds", kHolds[static_cast<int>(leg.hold)]},
                             {"ground", leg.ground},
                             {"point", leg.point},
                             {"normal", leg.normal},
                             {"lock", leg.lock}});
    }
  }
  void machine(int index, const GraphNode& n, Json& out) {
    const GraphMachineState<float>& m = block_.machine(graph_.slot(index));
    out["state"] = n.states[std::size_t(m.state)].name;
    out["seconds"] = m.time;
    if (m.transition >= 0) {
      static constexpr const char* kFades[] = {"none", "offset", "left pose", "crossfade", "smoothstep"};
      out["transition"] = {{"condition", condition_text(n.transitions[std::size_t(m.transition)].condition,
                                                        graph_.definition())},
                           {"fade", kFades[static_cast<int>(m.fade)]},
                           {"elapsed", m.elapsed},
                           {"duration", m.duration}};
    }
    if (graph_.machines()[std::size_t(graph_.slot(index))].fades) out["shown"] = shown(m).value;
    for (const GraphTransition& t : n.transitions)
      if (t.from == m.state || (t.from < 0 && t.to != m.state))
        out["waits"].push_back({{"to", n.states[std::size_t(t.to)].name},
                                {"condition", condition_text(t.condition, graph_.definition())},
                                {"holds", holds(graph_, block_, m, index, t)}});
    if (m.source >= 0) out["fades_from"] = node(n.states[std::size_t(m.source)].node);
    out["plays"] = node(n.states[std::size_t(m.posed)].node);
  }

  const Graph& graph_;
  GraphBlock<float> block_;
};

}  // namespace

std::string graph_dot(const GraphDefinition& graph) {
  return Dot(graph).draw();
}

Json describe_state(const Graph& graph, std::span<std::byte> state) {
  return Description(graph, state).run();
}

}  // namespace sinew::graph_tools
