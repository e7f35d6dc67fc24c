#include "sinew/graph/graph_file.h"

#include <limits>

#include "graph_generated.h"

namespace sinew {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

constexpr int kGraphMajor = 1, kGraphMinor = 2;  ///< newer major versions are refused, minor ones add fields
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
  if (in.kind() > static_cast<int>(TransitionKind::kSmoothstep) ||
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
  out.profile = text(in.profile());
  out.share = in.share();
  return {};
}

/// Up to three parameters.
Status unpack(const flatbuffers::Vector<std::int16_t>* in, int index, int (&out)[3]) {
  if (size_of(in) > 3) return bad("more than three parameters", index);
  for (unsigned k = 0; k < size_of(in); ++k) out[k] = in->Get(k);
  return {};
}

GraphFeet unpack(const fb::GraphFeet& in) {
  const fb::FootNumbers& n = *in.numbers();
  GraphFeet out;
  out.weight = unpack(*in.weight());
  out.level = in.level();
  out.locks = in.locks();
  out.settings = {n.lock_at(),   n.release_at(), n.lock_time(), n.release_time(),
                  n.half_life(), n.farthest(),   n.steepest()};
  out.reach = n.reach();
  out.follow = n.follow();
  out.rise = n.rise();
  out.deepest = n.deepest();
  out.lift = n.lift();
  return out;
}

Status unpack(const fb::GraphLook& in, int index, GraphLook& out) {
  const fb::LookNumbers& n = *in.numbers();
  out.weight = unpack(*in.weight());
  out.in_world = in.in_world();
  for (unsigned k = 0; k < size_of(in.joints()); ++k) out.joints.push_back(in.joints()->Get(k)->str());
  if (in.shares()) out.shares.assign(in.shares()->begin(), in.shares()->end());
  out.settings = {n.yaw(),    n.pitch_down(), n.pitch_up(),   n.softness(),
                  n.behind(), n.fastest(),    n.least_time(), n.half_life()};
  return unpack(in.target(), index, out.target);
}

/// What only some types of nodes have.
Status unpack_special(const fb::GraphNode& in, int index, GraphNode& out) {
  if (in.travel()) {
    out.travel.adds = in.travel()->adds();
    out.travel.weight = unpack(*in.travel()->weight());
    if (Status status = unpack(in.travel()->parameters(), index, out.travel.parameters); !status)
      return status;
  }
  if (in.feet()) out.feet = unpack(*in.feet());
  return in.look() ? unpack(*in.look(), index, out.look) : Status{};
}

Status unpack(const fb::GraphNode& in, int index, GraphNode& out) {
  if (in.type() > static_cast<int>(NodeType::kLook)) return bad("unknown type of node", index);
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
  return unpack_special(in, index, out);
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
  const auto profile = in.profile.empty() ? 0 : b.CreateString(in.profile);
  return fb::CreateGraphTransition(b, static_cast<std::int16_t>(in.from), static_cast<std::int16_t>(in.to),
                                   condition, static_cast<std::uint8_t>(in.kind), in.duration, in.budget,
                                   static_cast<std::uint8_t>(in.interrupt), listed, in.entry, profile,
                                   in.share);
}

Offset<fb::GraphTravel> pack(FlatBufferBuilder& b, const GraphTravel& in) {
  const auto parameters = b.CreateVector(narrow({in.parameters, in.parameters + 3}));
  const fb::GraphValue weight = pack(in.weight);
  return fb::CreateGraphTravel(b, parameters, in.adds, &weight);
}

Offset<fb::GraphFeet> pack(FlatBufferBuilder& b, const GraphFeet& in) {
  const fb::GraphValue weight = pack(in.weight);
  const FootSettings<float>& s = in.settings;
  const fb::FootNumbers numbers(s.lock_at, s.release_at, s.lock_time, s.release_time, s.half_life, s.farthest,
                                s.steepest, in.reach, in.follow, in.rise, in.deepest, in.lift);
  return fb::CreateGraphFeet(b, &weight, static_cast<std::int16_t>(in.level), in.locks, &numbers);
}

Offset<fb::GraphLook> pack(FlatBufferBuilder& b, const GraphLook& in) {
  const fb::GraphValue weight = pack(in.weight);
  const LookSettings<float>& s = in.settings;
  const fb::LookNumbers numbers(s.yaw, s.pitch_down, s.pitch_up, s.softness, s.behind, s.fastest,
                                s.least_time, s.half_life);
  const auto target = b.CreateVector(narrow({in.target, in.target + 3}));
  const auto joints = b.CreateVectorOfStrings(in.joints);
  const auto shares = b.CreateVector(in.shares);
  return fb::CreateGraphLook(b, &weight, target, in.in_world, joints, shares, &numbers);
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
  Offset<fb::GraphTravel> travel;
  Offset<fb::GraphFeet> feet;
  Offset<fb::GraphLook> look;
  if (in.type == NodeType::kTravel) travel = pack(b, in.travel);
  if (in.type == NodeType::kFeet) feet = pack(b, in.feet);
  if (in.type == NodeType::kLook) look = pack(b, in.look);
  return fb::CreateGraphNode(b, static_cast<std::uint8_t>(in.type), name, children, clip, &speed,
                             static_cast<std::int16_t>(in.group), in.root_motion, parameters, points,
                             layer_list, state_list, transition_list, static_cast<std::int16_t>(in.start),
                             travel, feet, look);
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
