#include "sinew/graph/graph_file.h"

#include <limits>

#include "graph_generated.h"

namespace sinew {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

constexpr int kGraphMajor = 1, kGraphMinor = 0;  ///< newer major versions are refused, minor ones add fields
constexpr int kMaxDepth = 16, kMaxTables = 200'000;

Status bad(const char* reason, int index = -1) {
  return Status::error(Code::kBadFile, reason, index);
}

template <class Value>
std::size_t size_of(const flatbuffers::Vector<Value>* v) {
  return v ? v->size() : 0;
}

std::string text(const flatbuffers::String* s) {
  return s ? s->str() : std::string();
}

std::vector<int> whole(const flatbuffers::Vector<std::int16_t>* v) {
  return v ? std::vector<int>(v->begin(), v->end()) : std::vector<int>();
}

GraphValue unpack(const fb::GraphValue& v) {
  return {v.constant(), v.parameter()};
}

Status unpack(const fb::GraphTransition& in, GraphTransition& out) {
  if (in.kind() > static_cast<int>(TransitionKind::kCut) ||
      in.interrupt() > static_cast<int>(Interruption::kNever))
    return bad("unknown kind of transition");
  out.from = in.from();
  out.to = in.to();
  for (unsigned k = 0; k < size_of(in.condition()); ++k) {
    const fb::ConditionStep& step = *in.condition()->Get(k);
    if (step.code() > static_cast<int>(ConditionCode::kNot)) return bad("unknown step of a condition");
    out.condition.push_back({static_cast<ConditionCode>(step.code()), step.index(), step.value()});
  }
  out.kind = static_cast<TransitionKind>(in.kind());
  out.duration = in.duration();
  out.budget = in.budget();
  out.interrupt = static_cast<Interruption>(in.interrupt());
  out.interrupted_by = whole(in.interrupted_by());
  out.entry = in.entry();
  return {};
}

Status unpack(const fb::GraphNode& in, int index, GraphNode& out) {
  if (in.type() > static_cast<int>(NodeType::kMirror)) return bad("unknown type of node", index);
  out.type = static_cast<NodeType>(in.type());
  out.name = in.name()->str();
  out.children = whole(in.children());
  out.clip = text(in.clip());
  if (in.speed()) out.speed = unpack(*in.speed());
  out.group = in.group();
  out.root_motion = in.root_motion();
  if (size_of(in.parameters()) > 2) return bad("a blend has more than two parameters", index);
  for (unsigned k = 0; k < size_of(in.parameters()); ++k) out.parameters[k] = in.parameters()->Get(k);
  if (in.points()) out.points.assign(in.points()->begin(), in.points()->end());
  for (unsigned k = 0; k < size_of(in.layers()); ++k) {
    const fb::GraphLayer& layer = *in.layers()->Get(k);
    if (layer.mode() > static_cast<int>(LayerMode::kMeshAdditive))
      return bad("unknown mode of a layer", index);
    out.layers.push_back({text(layer.mask()), unpack(*layer.weight()), static_cast<LayerMode>(layer.mode()),
                          text(layer.reference()), layer.reference_time()});
  }
  for (unsigned k = 0; k < size_of(in.states()); ++k)
    out.states.push_back({in.states()->Get(k)->name()->str(), in.states()->Get(k)->node()});
  for (unsigned k = 0; k < size_of(in.transitions()); ++k)
    if (Status status = unpack(*in.transitions()->Get(k), out.transitions.emplace_back()); !status) {
      status.index = index;
      return status;
    }
  out.start = in.start();
  return {};
}

Status unpack(const fb::GraphParameter& in, int index, GraphParameter& out) {
  if (in.type() > static_cast<int>(ParameterType::kTrigger)) return bad("unknown type of parameter", index);
  out = {in.name()->str(), static_cast<ParameterType>(in.type()), in.value(), in.half_life(), in.buffer()};
  return {};
}

std::vector<std::int16_t> narrow(const std::vector<int>& v) {
  std::vector<std::int16_t> out;
  for (const int i : v) out.push_back(static_cast<std::int16_t>(i));
  return out;
}

fb::GraphValue pack(const GraphValue& v) {
  return {v.constant, static_cast<std::int16_t>(v.parameter)};
}

Offset<fb::GraphTransition> pack(FlatBufferBuilder& b, const GraphTransition& in) {
  std::vector<fb::ConditionStep> steps;
  for (const ConditionStep& s : in.condition)
    steps.emplace_back(static_cast<std::uint8_t>(s.code), s.index, s.value);
  const auto condition = b.CreateVectorOfStructs(steps);
  const auto listed = b.CreateVector(narrow(in.interrupted_by));
  return fb::CreateGraphTransition(b, static_cast<std::int16_t>(in.from), static_cast<std::int16_t>(in.to),
                                   condition, static_cast<std::uint8_t>(in.kind), in.duration, in.budget,
                                   static_cast<std::uint8_t>(in.interrupt), listed, in.entry);
}

Offset<fb::GraphNode> pack(FlatBufferBuilder& b, const GraphNode& in) {
  std::vector<Offset<fb::GraphLayer>> layers;
  for (const GraphLayer& layer : in.layers) {
    const auto mask = b.CreateString(layer.mask), reference = b.CreateString(layer.reference);
    const fb::GraphValue weight = pack(layer.weight);
    layers.push_back(fb::CreateGraphLayer(b, mask, &weight, static_cast<std::uint8_t>(layer.mode), reference,
                                          layer.reference_time));
  }
  std::vector<Offset<fb::GraphState>> states;
  for (const GraphState& state : in.states)
    states.push_back(
        fb::CreateGraphState(b, b.CreateString(state.name), static_cast<std::int16_t>(state.node)));
  std::vector<Offset<fb::GraphTransition>> transitions;
  for (const GraphTransition& t : in.transitions) transitions.push_back(pack(b, t));
  const auto name = b.CreateString(in.name), clip = b.CreateString(in.clip);
  const auto children = b.CreateVector(narrow(in.children)),
             parameters = b.CreateVector(narrow({in.parameters[0], in.parameters[1]}));
  const auto points = b.CreateVector(in.points);
  const auto layer_list = b.CreateVector(layers);
  const auto state_list = b.CreateVector(states);
  const auto transition_list = b.CreateVector(transitions);
  const fb::GraphValue speed = pack(in.speed);
  return fb::CreateGraphNode(b, static_cast<std::uint8_t>(in.type), name, children, clip, &speed,
                             static_cast<std::int16_t>(in.group), in.root_motion, parameters, points,
                             layer_list, state_list, transition_list, static_cast<std::int16_t>(in.start));
}

}  // namespace

Status read_graph(std::span<const std::uint8_t> bytes, GraphDefinition& out) {
  if (bytes.size() < 16) return bad("too short for a graph");
  if (bytes.size() > std::size_t(std::numeric_limits<std::int32_t>::max())) return bad("larger than 2 GiB");
  if (!fb::GraphBufferHasIdentifier(bytes.data())) return bad("not a graph");
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxDepth, kMaxTables);
  if (!fb::VerifyGraphBuffer(verifier)) return bad("truncated or damaged");
  const fb::Graph& in = *fb::GetGraph(bytes.data());
  if (in.schema_major() > kGraphMajor)
    return Status::error(Code::kBadVersion, "written by a newer version of Sinew");
  if (in.schema_major() < 1) return bad("has no version");

  GraphDefinition graph;
  graph.name = in.name()->str();
  for (unsigned k = 0; k < size_of(in.parameters()); ++k)
    if (Status status =
            unpack(*in.parameters()->Get(k), static_cast<int>(k), graph.parameters.emplace_back());
        !status)
      return status;
  for (unsigned k = 0; k < size_of(in.groups()); ++k) graph.groups.push_back(in.groups()->Get(k)->str());
  for (unsigned k = 0; k < size_of(in.events()); ++k) graph.events.push_back(in.events()->Get(k)->str());
  for (unsigned k = 0; k < in.nodes()->size(); ++k)
    if (Status status = unpack(*in.nodes()->Get(k), static_cast<int>(k), graph.nodes.emplace_back()); !status)
      return status;
  if (Status status = validate(graph); !status) return status;
  out = std::move(graph);
  return {};
}

std::vector<std::uint8_t> write_graph(const GraphDefinition& graph) {
  FlatBufferBuilder b;
  std::vector<Offset<fb::GraphParameter>> parameters;
  for (const GraphParameter& p : graph.parameters)
    parameters.push_back(fb::CreateGraphParameter(
        b, b.CreateString(p.name), static_cast<std::uint8_t>(p.type), p.value, p.half_life, p.buffer));
  std::vector<Offset<fb::GraphNode>> nodes;
  for (const GraphNode& node : graph.nodes) nodes.push_back(pack(b, node));
  const auto name = b.CreateString(graph.name);
  const auto parameter_list = b.CreateVector(parameters);
  const auto groups = b.CreateVectorOfStrings(graph.groups), events = b.CreateVectorOfStrings(graph.events);
  const auto node_list = b.CreateVector(nodes);
  b.Finish(fb::CreateGraph(b, kGraphMajor, kGraphMinor, name, parameter_list, groups, events, node_list),
           fb::GraphIdentifier());
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

}  // namespace sinew
