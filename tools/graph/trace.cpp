#include "graph/trace.h"

#include <algorithm>
#include <cmath>

#include "graph/describe.h"
#include "sinew/graph/graph_step.h"

namespace sinew::graph_tools {

std::string InputScript::read(const std::string& text, const std::string& path,
                              const GraphDefinition& graph) {
  try {
    const LocatedJson located = parse_located(text);
    if (!located.value.is_array()) throw Fault(1, "expected a list of inputs");
    for (std::size_t k = 0; k < located.value.size(); ++k) {
      const Json& row = located.value[k];
      const int line = located.line("/" + std::to_string(k));
      if (!row.is_array() || row.size() < 2 || row.size() > 3 || !row[0].is_number() || !row[1].is_string())
        throw Fault(line, "an input is [seconds, \"parameter\", value] or [seconds, \"trigger\"]");
      Input input{row[0].get<double>(), graph.find_parameter(row[1].get<std::string>()), 0};
      if (input.parameter < 0) throw Fault(line, "no parameter '" + row[1].get<std::string>() + "'");
      const bool trigger = graph.parameters[std::size_t(input.parameter)].type == ParameterType::kTrigger;
      if (trigger != (row.size() == 2))
        throw Fault(line, trigger ? "a trigger has no value" : "value is missing");
      if (!trigger && !row[2].is_number() && !row[2].is_boolean())
        throw Fault(line, "value is no number, true or false");
      if (!trigger) input.value = row[2].is_boolean() ? float(row[2].get<bool>()) : row[2].get<float>();
      if (!std::isfinite(input.value) || !std::isfinite(input.time))
        throw Fault(line, "number is not finite");
      inputs.push_back(input);
    }
  } catch (const Fault& fault) {
    return path + ":" + std::to_string(fault.line) + ": " + fault.what();
  }
  std::stable_sort(inputs.begin(), inputs.end(),
                   [](const Input& a, const Input& b) { return a.time < b.time; });
  return {};
}

void InputScript::apply(const Graph& graph, std::span<std::byte> state, double from, double to) const {
  GraphParameters<float> parameters(graph, state);
  for (const Input& input : inputs) {
    if (input.time < from || input.time >= to) continue;
    if (graph.definition().parameters[std::size_t(input.parameter)].type == ParameterType::kTrigger)
      (void)parameters.trigger(input.parameter);
    else
      (void)parameters.set(input.parameter, input.value);
  }
}

Status trace_graph(const Graph& graph, const Asset& asset, const InputScript& inputs, double seconds,
                   double rate, std::ostream& rows, Json& end) {
  GraphScratch<float> scratch(graph);
  std::vector<std::byte> state(graph.state_bytes<float>());
  if (Status status = start_graph<float>(graph, state); !status) return status;
  std::vector<JointJet<float>> jets(std::size_t(graph.joint_count()));
  for (std::size_t j = 0; j < jets.size(); ++j) {
    jets[j].rotation = graph.rest()[j].rotation;
    jets[j].translation = graph.rest()[j].translation;
  }
  std::vector<EventHit> hits(256);
  rows << "time";
  for (const Graph::BoundMachine& machine : graph.machines()) rows << "," << graph.node(machine.node).name;
  rows << ",x,y,heading,joint,angular_acceleration,events\n";
  const int frames = static_cast<int>(seconds * rate);
  for (int k = 0; k <= frames; ++k) {
    const double time = k / rate, h = k == 0 ? 0 : 1 / rate;
    inputs.apply(graph, state, k == 0 ? -1e300 : time - h, k == 0 ? 1e-9 : time - 1e-9);
    EventSink events{hits};
    if (Status status = GraphStepJob<float>{&graph, state, float(h), &scratch, jets, &events, {}, jets}.Run(); !status)
      return status;
    GraphParameters<float> parameters(graph, state);
    rows << time;
    for (const Graph::BoundMachine& machine : graph.machines())
      rows << "," << graph.node(machine.node).states[std::size_t(parameters.state(machine.node))].name;
    std::size_t worst = 0;
    for (std::size_t j = 1; j < jets.size(); ++j)
      if (jets[j].alpha.norm() > jets[worst].alpha.norm()) worst = j;
    rows << "," << parameters.place().x() << "," << parameters.place().y() << "," << parameters.heading()
         << "," << asset.skeleton.joints[worst].name << "," << jets[worst].alpha.norm() << ",";
    for (int e = 0; e < events.count; ++e) {
      const auto name = std::find_if(
          asset.event_names.begin(), asset.event_names.end(),
          [&](const std::string& n) { return event_name(n) == hits[std::size_t(e)].event->name; });
      rows << (e ? " " : "") << *name;
    }
    rows << "\n";
  }
  end = describe_state(graph, state);
  return {};
}

}  // namespace sinew::graph_tools
