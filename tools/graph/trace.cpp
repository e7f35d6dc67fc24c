#include "graph/trace.h"

#include <algorithm>
#include <cmath>

#include "graph/attribution.h"
#include "graph/describe.h"
#include "sinew/graph/graph_recorder.h"

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

namespace {

/// A name as a cell of CSV.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// "graph/move 61 %, graph/move/1 30 %": parts of the acceleration along itself, those above a hundredth.
std::string shares_text(const Graph& graph, const Attribution& attribution, const Vec3<float>& alpha) {
  const float length = alpha.norm();
  std::string text;
  if (!(length > 0)) return text;
  for (const AccelerationShare& share : attribution.shares()) {
    const int percent = static_cast<int>(std::lround(100 * share.alpha.dot(alpha) / (length * length)));
    if (percent == 0) continue;
    text += (text.empty() ? "" : "; ") + graph.node(share.node).name + (share.time ? " (time) " : " ") +
            std::to_string(percent) + " %";
  }
  return text;
}

class Trace {
 public:
  Trace(const Graph& graph, const Asset& asset, const TraceOptions& options, std::ostream& rows)
      : graph_(graph),
        asset_(asset),
        options_(options),
        rows_(rows),
        jets_(std::size_t(graph.joint_count())) {
    for (std::size_t j = 0; j < jets_.size(); ++j) {
      jets_[j].rotation = graph.rest()[j].rotation;
      jets_[j].translation = graph.rest()[j].translation;
    }
    rows_ << "time";
    for (const Graph::BoundMachine& machine : graph.machines())
      rows_ << "," << cell(graph.node(machine.node).name);
    rows_ << ",x,y,heading,joint,angular_acceleration,comes_from,events\n";
  }
  Status run(const InputScript& inputs, Json& end) {
    if (Status status = start_graph<float>(graph_, state_); !status) return status;
    const int frames = static_cast<int>(options_.seconds * options_.rate);
    for (int k = 0; k <= frames; ++k) {
      const double time = k / options_.rate, h = k == 0 ? 0 : 1 / options_.rate;
      inputs.apply(graph_, state_, k == 0 ? -1e300 : time - h, k == 0 ? 1e-9 : time - 1e-9);
      if (Status status = frame(time, h); !status) return status;
    }
    end = describe_state(graph_, state_);
    return {};
  }

 private:
  Status frame(double time, double h) {
    EventSink events{hits_};
    Attribution attribution(graph_, scratch_, options_.joint);
    GraphStepJob<float> job{&graph_, state_, float(h), &scratch_, jets_, &events, {}, jets_};
    if (options_.joint >= 0) job.watch = attribution.watch();
    if (Status status = options_.recording ? recorder_.step(job) : job.Run(); !status) return status;
    GraphParameters<float> parameters(graph_, state_);
    rows_ << time;
    for (const Graph::BoundMachine& machine : graph_.machines())
      rows_ << ","
            << cell(graph_.node(machine.node).states[std::size_t(parameters.state(machine.node))].name);
    const std::size_t joint = options_.joint >= 0 ? std::size_t(options_.joint) : busiest();
    const Vec3<float>& alpha = jets_[joint].alpha;
    rows_ << "," << parameters.place().x() << "," << parameters.place().y() << "," << parameters.heading()
          << "," << cell(asset_.skeleton.joints[joint].name) << "," << alpha.norm() << ",";
    if (options_.joint >= 0) rows_ << cell(shares_text(graph_, attribution, alpha));
    rows_ << ",";
    for (int e = 0; e < events.count; ++e)
      rows_ << (e ? " " : "") << cell(name_of(hits_[std::size_t(e)].event->name));
    rows_ << "\n";
    return {};
  }
  std::size_t busiest() const {
    const auto less = [](const JointJet<float>& a, const JointJet<float>& b) {
      return a.alpha.norm() < b.alpha.norm();
    };
    return std::size_t(std::max_element(jets_.begin(), jets_.end(), less) - jets_.begin());
  }
  std::string name_of(std::uint32_t number) const {
    for (const std::string& name : asset_.event_names)
      if (event_name(name) == number) return name;
    return std::to_string(number);
  }

  const Graph& graph_;
  const Asset& asset_;
  const TraceOptions& options_;
  std::ostream& rows_;
  GraphScratch<float> scratch_{graph_};
  GraphMemory state_ = GraphMemory(graph_.state_bytes<float>());
  std::vector<JointJet<float>> jets_;
  std::vector<EventHit> hits_ = std::vector<EventHit>(256);
  GraphRecorder<float> recorder_{
      graph_, options_.recording ? std::span<std::byte>(*options_.recording) : std::span<std::byte>()};
};

}  // namespace

Status trace_graph(const Graph& graph, const Asset& asset, const InputScript& inputs,
                   const TraceOptions& options, std::ostream& rows, Json& end) {
  return Trace(graph, asset, options, rows).run(inputs, end);
}

}  // namespace sinew::graph_tools
