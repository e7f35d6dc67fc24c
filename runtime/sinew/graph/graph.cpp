#include "sinew/graph/graph.h"

#include <algorithm>

#include "sinew/animation/sampling_job.h"
#include "sinew/animation/side_names.h"
#include "sinew/graph/graph_file.h"
#include "sinew/graph/graph_keep.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {
namespace {

Status bad(const char* reason, int node) {
  return Status::error(Code::kInvalidArgument, reason, node);
}

constexpr int kBlendNodes = 33;  ///< of a baked blend, along each dimension

/// One after the first joint whose translation a clip changes.
int translated_by(const Clip& clip, const std::vector<Transform<float>>& rest) {
  int most = 0;
  for (const Clip::Group& group : clip.groups)
    for (const Clip::Track& track : group.tracks)
      if (!group.rotation) most = std::max(most, track.joint + 1);
  for (std::size_t j = 0; j < clip.constants.size(); ++j)
    if (!clip.constants[j].translation.isApprox(rest[j].translation, 1e-5f))
      most = std::max(most, int(j) + 1);
  return most;
}

bool begins_offset(const GraphTransition& t) {
  return t.kind != TransitionKind::kCut;  // a crossfade that interrupts one is inertial
}

/// What emitting a node's tasks once takes at most, itself and all below it.
struct Needs {
  int registers = 1, tasks = 0, weights = 0, members = 0;
};

/// How many registers further on than itself a node's k-th child is made.
int base_of(const GraphNode& node, int k) {
  if (node.type == NodeType::kBlend) return k;
  return node.type == NodeType::kMachine || (node.type == NodeType::kLayers && k > 0) ? 1 : 0;
}

Needs needs_of(const GraphNode& node, const std::vector<Needs>& all) {
  Needs sum;
  const auto add = [&](int child, int base) {
    const Needs& c = all[std::size_t(child)];
    sum.registers = std::max(sum.registers, base + c.registers);
    sum.tasks += c.tasks;
    sum.weights += c.weights;
    sum.members += c.members;
  };
  const int children = static_cast<int>(node.children.size());
  for (int k = 0; k < children; ++k) add(node.children[std::size_t(k)], base_of(node, k));
  sum.tasks += std::max(3, children);
  sum.weights += std::max(1, children);
  sum.members += node.type == NodeType::kClip;
  return sum;
}

/// Of a frame in which every machine changes its state: what plays, and at each change what played and what
/// follows.
Needs most_needs(const GraphDefinition& graph) {
  std::vector<Needs> all;
  for (const GraphNode& node : graph.nodes) all.push_back(needs_of(node, all));
  Needs sum = all.back();
  ++sum.registers;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (graph.nodes[k].type != NodeType::kMachine) continue;
    ++sum.registers;
    sum.tasks += 2 * all[k].tasks + 2;
    sum.weights += 2 * all[k].weights;
    sum.members += 2 * all[k].members;
  }
  return sum;
}

std::size_t rounded(std::size_t bytes) {
  return (bytes + 15) / 16 * 16;
}

template <class T>
GraphLayout layout_of(const Graph& graph) {
  GraphLayout at;
  std::size_t end = rounded(sizeof(GraphHeader<T>));
  const auto place = [&](std::size_t bytes) {
    const std::size_t begin = end;
    end += rounded(bytes);
    return begin;
  };
  const auto offsets = std::size_t(std::count_if(graph.machines().begin(), graph.machines().end(),
                                                 [](const auto& m) { return m.offset >= 0; }));
  const auto times = std::size_t(
      std::count_if(graph.clips().begin(), graph.clips().end(), [](const auto& c) { return c.time >= 0; }));
  at.parameters = place(graph.definition().parameters.size() * sizeof(GraphParameterState<T>));
  at.groups = place(graph.definition().groups.size() * sizeof(GraphGroupState));
  at.clips = place(times * sizeof(TimeJet<double>));
  at.fresh = place((graph.clips().size() + 7) / 8);
  at.machines = place(graph.machines().size() * sizeof(GraphMachineState<T>));
  at.offsets = place(offsets * rounded(kept_bytes<T>(graph.joint_count(), graph.translated())));
  at.curve_offsets = place(offsets * std::size_t(graph.curve_count()) * sizeof(TimeJet<T>));
  at.feet = place(graph.feet().node >= 0 ? sizeof(GraphFeetState<T>) : 0);
  at.looks = place(graph.looks().size() * sizeof(GraphLookState<T>));
  at.bytes = end;
  return at;
}

}  // namespace

Status Graph::bind_clip(int index, const Asset& asset) {
  const GraphNode& in = node(index);
  const int found = asset.find_clip(in.clip);
  if (found < 0) return bad("the asset has no clip of this name", index);
  BoundClip bound{.clip = &asset.clips[std::size_t(found)], .map = {}, .node = index, .mirrored_events = {}};
  if (mirrored_[std::size_t(index)]) {
    const EventMirror mirror = mirror_events(asset.event_names);
    bound.mirrored_events = bound.clip->events;
    for (ClipEvent& event : bound.mirrored_events) event.name = mirror(event.name);
  }
  if (in.group < 0)
    bound.time = static_cast<int>(
        std::count_if(clips_.begin(), clips_.end(), [](const BoundClip& c) { return c.time >= 0; }));
  if (in.group >= 0) {
    if (!bound.clip->loops) return bad("a clip that does not loop cannot be synchronised", index);
    if (bound.clip->markers.empty()) return bad("a synchronised clip has no markers of its phase", index);
    std::vector<PhaseMarker> markers = bound.clip->markers;
    for (PhaseMarker& marker : markers) marker.phase += mirrored_[std::size_t(index)] ? 0.5 : 0.0;
    if (Status status = fit_phase_map(markers, double(bound.clip->duration), bound.clip->cycles, bound.map);
        !status)
      return bad(status.reason, index);
  }
  translated_ = std::max(translated_, translated_by(*bound.clip, rest_));
  slots_[std::size_t(index)] = static_cast<int>(clips_.size());
  clips_.push_back(std::move(bound));
  return {};
}

Status Graph::bind_mirrors(const Asset& asset) {
  mirrored_.assign(definition_.nodes.size(), 0);
  bool any = false;
  for (std::size_t k = definition_.nodes.size(); k-- > 0;) {  // parents come after their children
    const bool mirror = node(static_cast<int>(k)).type == NodeType::kMirror;
    any |= mirror;
    for (const int child : node(static_cast<int>(k)).children)
      mirrored_[std::size_t(child)] = static_cast<char>(mirrored_[k] != static_cast<char>(mirror));
  }
  if (!any) return {};
  if (Status status = build_mirror_map(asset.skeleton, mirror_float_); !status) return status;
  return build_mirror_map(asset.skeleton, mirror_double_);
}

Status Graph::bind_layers(int index, const Asset& asset) {
  slots_[std::size_t(index)] = static_cast<int>(layers_.size());
  for (const GraphLayer& in : node(index).layers) {
    BoundLayer& layer = layers_.emplace_back();
    if (!in.mask.empty() && (layer.mask = asset.find_mask(in.mask)) < 0)
      return bad("the asset has no mask of this name", index);
    if (in.mode == LayerMode::kOverride) continue;
    layer.reference = rest_;
    if (in.reference.empty()) continue;
    const int clip = asset.find_clip(in.reference);
    if (clip < 0) return bad("the asset has no clip of the reference's name", index);
    const SamplingJob<float> job{
        &asset.clips[std::size_t(clip)], double(in.reference_time), {}, layer.reference};
    if (Status status = job.Run(); !status) return bad(status.reason, index);
  }
  return {};
}

Status Graph::bind_blend(int index) {
  const GraphNode& in = node(index);
  slots_[std::size_t(index)] = static_cast<int>(spaces_.size());
  const std::vector<double> points(in.points.begin(), in.points.end());
  BlendSpace& space = spaces_.emplace_back();
  if (in.children.size() == 1) {  // nothing to mix
    space.clips = 1;
    space.node_weights = {1};
    return {};
  }
  const int dimensions = in.parameters[1] >= 0 ? 2 : 1;
  if (Status status = bake_blend_space(points, dimensions, kBlendNodes, space); !status)
    return bad(status.reason, index);
  return {};
}

Status Graph::bind_machine(int index, const Asset& asset) {
  const GraphNode& in = node(index);
  slots_[std::size_t(index)] = static_cast<int>(machines_.size());
  BoundMachine machine;
  machine.node = index;
  machine.fades = has_empty_state(definition_, index);
  if (std::any_of(in.transitions.begin(), in.transitions.end(), begins_offset))
    machine.offset = static_cast<int>(
        std::count_if(machines_.begin(), machines_.end(), [](const auto& m) { return m.offset >= 0; }));
  for (const GraphTransition& t : in.transitions) {
    machine.profiles.push_back(t.profile.empty() ? -1 : asset.find_mask(t.profile));
    if (!t.profile.empty() && machine.profiles.back() < 0)
      return bad("the asset has no mask of the name of a transition's profile", index);
  }
  machines_.push_back(machine);
  return {};
}

Status Graph::bind_feet(int index, const Asset& asset) {
  Status status = find_foot_legs<float>(asset.skeleton, feet_.legs_float, feet_.pelvis);
  if (status) status = find_foot_legs<double>(asset.skeleton, feet_.legs_double, feet_.pelvis);
  if (!status) return bad(status.reason, index);
  feet_.node = index;
  for (const FootLeg<float>& leg : feet_.legs_float) feet_.joints = std::max(feet_.joints, leg.foot + 1);
  return {};
}

Status Graph::bind_look(int index, const Asset& asset) {
  const GraphLook& in = node(index).look;
  slots_[std::size_t(index)] = static_cast<int>(looks_.size());
  BoundLook& look = looks_.emplace_back();
  if (in.joints.empty()) {
    Status status = find_look_chain(asset.skeleton, look.chain_float);
    if (status) status = find_look_chain(asset.skeleton, look.chain_double);
    return status ? status : bad(status.reason, index);
  }
  std::vector<int> joints;
  const std::vector<double> shares(in.shares.begin(), in.shares.end());
  for (const std::string& name : in.joints)
    if (joints.push_back(asset.skeleton.find(name.c_str())); joints.back() < 0)
      return bad("the asset has no joint of the look's names", index);
  Status status = make_look_chain<float>(asset.skeleton, joints, shares, look.chain_float);
  if (status) status = make_look_chain<double>(asset.skeleton, joints, shares, look.chain_double);
  return status ? status : bad(status.reason, index);
}

void Graph::lay_out() {
  registers_ = most_needs(definition_).registers;
  layouts_[0] = layout_of<float>(*this);
  layouts_[1] = layout_of<double>(*this);
  hash_ = 14695981039346656037u;
  const auto mix = [&](std::uint64_t v) { hash_ = (hash_ ^ v) * 1099511628211u; };
  for (const std::uint8_t byte : write_graph(definition_)) mix(byte);
  mix(std::uint64_t(joint_count_));
  mix(curve_slots_.size());
  for (const GraphLayout& at : layouts_) mix(at.bytes);
}

Status Graph::bind_node(int index, const Asset& asset) {
  switch (node(index).type) {
    case NodeType::kClip:
      return bind_clip(index, asset);
    case NodeType::kBlend:
      return bind_blend(index);
    case NodeType::kLayers:
      return bind_layers(index, asset);
    case NodeType::kMachine:
      return bind_machine(index, asset);
    case NodeType::kFeet:
      return bind_feet(index, asset);
    case NodeType::kLook:
      return bind_look(index, asset);
    case NodeType::kEmpty:
    case NodeType::kPhysical:
    case NodeType::kMirror:
    case NodeType::kTravel:
      break;
  }
  return {};
}

Status Graph::bind_physics(const Asset& asset) {
  for (std::size_t k = 0; k < definition_.parameters.size(); ++k) {
    const GraphParameter& p = definition_.parameters[k];
    std::size_t at = 0;
    const int value = p.type == ParameterType::kFloat ? physics_value(p.name, at) : -1;
    if (value < 0) continue;  // the game's own
    const int mask = at > 0 ? asset.find_mask(p.name.substr(at)) : -1;
    if (at > 0 && mask < 0)
      return bad("the asset has no mask of the name that a load's parameter ends with", -1);
    physics_.push_back({static_cast<int>(k), value, mask});
  }
  return {};
}

Status Graph::bind(const GraphDefinition& definition, const Asset& asset, Graph& out) {
  if (Status status = validate(definition); !status) return status;
  if (asset.skeleton.joints.empty()) return bad("the asset has no joints", -1);
  Graph graph;
  graph.definition_ = definition;
  graph.joint_count_ = static_cast<int>(asset.skeleton.joints.size());
  for (const Joint& joint : asset.skeleton.joints) {
    graph.parents_.push_back(joint.parent);
    graph.rest_.push_back(joint.rest.cast<float>());
  }
  graph.masks_ = asset.masks;
  graph.curve_slots_ = asset.curve_slots;
  for (const std::string& name : definition.events) graph.event_names_.push_back(event_name(name));
  graph.slots_.assign(definition.nodes.size(), -1);
  if (Status status = graph.bind_mirrors(asset); !status) return bad(status.reason, -1);
  if (Status status = graph.bind_physics(asset); !status) return status;
  for (int k = 0; k < static_cast<int>(definition.nodes.size()); ++k)
    if (Status status = graph.bind_node(k, asset); !status) return status;
  graph.lay_out();
  out = std::move(graph);
  return {};
}

std::uint32_t Graph::event_bit(std::uint32_t name) const {
  for (std::size_t k = 0; k < event_names_.size(); ++k)
    if (event_names_[k] == name) return std::uint32_t(1) << k;
  return 0;
}

template <class T>
GraphScratch<T>::GraphScratch(const Graph& graph) : hash(graph.hash()) {
  const std::size_t joints = std::size_t(graph.joint_count()), slots = std::size_t(graph.curve_count()),
                    count = std::size_t(graph.registers());
  const Needs needs = most_needs(graph.definition());
  jets.resize(count * joints);
  curves.assign(count * slots, TimeJet<T>(T(0)));
  for (std::size_t k = 0; k < count; ++k)
    registers.push_back({{jets.data() + k * joints, joints}, {curves.data() + k * slots, slots}, {}});
  for (const JointMask& mask : graph.masks()) mask.write(std::span<T>(masks.emplace_back(joints)));
  for (const Transform<float>& x : graph.rest()) rest.push_back(x.template cast<T>());
  for (int n = 0; n < static_cast<int>(graph.definition().nodes.size()); ++n) {
    if (graph.node(n).type != NodeType::kLayers) continue;
    for (int k = 0; k < static_cast<int>(graph.node(n).layers.size()); ++k) {
      std::vector<Transform<T>>& reference = references.emplace_back();
      for (const Transform<float>& x : graph.layer(n, k).reference) reference.push_back(x.template cast<T>());
    }
  }
  rotations.resize(2 * joints);
  offset.resize(inertial_numbers(graph.joint_count(), graph.translated()));
  left.resize(joints);
  profile.resize(joints);
  tasks.resize(std::size_t(needs.tasks));
  weights.resize(std::size_t(needs.weights));
  members.resize(std::size_t(needs.members));
  phase_members.resize(std::size_t(needs.members));
  times.resize(std::size_t(needs.members));
  before.resize(graph.clips().size());
  now.resize(graph.clips().size());
  phases.resize(graph.definition().groups.size());
  changes.resize(graph.machines().size());
  shares.resize(graph.clips().size());
  hits.resize(kMostHits);
}

template <class T>
Status check_scratch(const Graph& graph, const GraphScratch<T>* scratch) {
  if (scratch && scratch->hash == graph.hash()) return {};
  return Status::error(Code::kInvalidArgument, "no scratch, or that of another graph");
}

template struct GraphScratch<float>;
template struct GraphScratch<double>;
template Status check_scratch<float>(const Graph&, const GraphScratch<float>*);
template Status check_scratch<double>(const Graph&, const GraphScratch<double>*);

}  // namespace sinew
