#include "sinew/graph/graph_update.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/smooth_input.h"
#include "sinew/graph/graph_walk.h"

namespace sinew {
namespace {

/// What is usual, for comparison.
template <class T>
TimeJet<T> smoothstep(T elapsed, T duration) {
  if (!(elapsed < duration)) return TimeJet<T>(T(1));
  const T u = elapsed / duration;
  return {u * u * (T(3) - T(2) * u), T(6) * u * (T(1) - u) / duration,
          (T(6) - T(12) * u) / (duration * duration)};
}

/// Keeps the order of those at one time; takes no memory, as std::stable_sort does.
void sort_by_time(std::span<EventHit> hits) {
  const auto earlier = [](const EventHit& a, const EventHit& b) { return a.seconds_ago > b.seconds_ago; };
  for (auto at = hits.begin(); at != hits.end(); ++at)
    std::rotate(std::upper_bound(hits.begin(), at, *at, earlier), at, at + 1);
}

template <class T>
class Update {
 public:
  Update(const GraphUpdateJob<T>& job)
      : graph_(*job.graph), block_(graph_, job.state), s_(*job.scratch), events_(job.events), h_(job.h) {}

  Status run() {
    clear();
    s_.h = h_;
    const int first = events_ ? events_->count : 0;
    if (block_.header().begun == 0) {  // phases pass as fast as their clips ask from the start on
      emit(graph_.root(), 0, TimeJet<T>(T(1)), false);
      if (Status status = move_phases(0); !status) return status;
      clear();
    }
    decide(graph_.root());
    if (Status status = begin_offsets(); !status) return status;
    filter();
    block_.header().events = 0;
    for (std::size_t g = 0; g < s_.phases.size(); ++g) {
      s_.phases[g] = block_.group(int(g)).phase.value;
      block_.group(int(g)).active = 0;
    }
    advance(graph_.root());
    emit(graph_.root(), 0, TimeJet<T>(T(1)), false);
    if (Status status = move_phases(double(h_)); !status) return status;
    report(graph_.root());
    if (events_) sort_by_time(events_->hits.subspan(std::size_t(first), std::size_t(events_->count - first)));
    block_.header().begun = 1;
    return {};
  }

 private:
  void clear() { s_.task_count = s_.weight_count = s_.member_count = s_.change_count = 0; }

  // Changes of state, at the start of the frame.
  struct Choice {
    int legs[GraphDefinition::kMostConduits + 1] =
        {};  ///< transitions, through conduits; the last reaches `to`
    int count = 0;
    int to = -1;
  };
  void decide(int node);
  bool may_interrupt(const GraphNode& node, const GraphMachineState<T>& m, int to) const;
  Choice choose(int index, const GraphMachineState<T>& m) const;
  bool follow(int index, const GraphMachineState<T>& m, int from, Choice& choice) const;
  void use_up(const GraphNode& node, const Choice& choice);
  void take(int index, int machine, const Choice& choice);
  void start_showing(GraphMachineState<T>& m, T target, T duration);
  void leave(int node);
  Status begin_offsets();

  // What lasts, moved on.
  void filter();
  void advance(int node);
  void advance_machine(int index);
  Status move_phases(double h);

  // What plays now, as tasks. `now`: synchronised clips are where their groups are; else move_phases() will
  // say.
  void emit(int node, int base, const TimeJet<T>& weight, bool now);
  void emit_clip(int index, int base, const TimeJet<T>& weight, bool now);
  void emit_blend(int index, int base, const TimeJet<T>& weight, bool now);
  void emit_layers(int index, int base, const TimeJet<T>& weight, bool now);
  void emit_machine(int index, int base, const TimeJet<T>& weight, bool now);
  void emit_single(typename GraphTask::Kind kind, const GraphValue& how_much, int index, int base,
                   const TimeJet<T>& weight, bool now);
  GraphTask& task(typename GraphTask::Kind kind, int base, int index) {
    GraphTask& t = s_.tasks[std::size_t(s_.task_count++)];
    t = {};
    t.kind = kind;
    t.at_change = prelude_;
    t.whole = prelude_ || mirrored_ > 0;
    t.out = static_cast<std::uint16_t>(base);
    t.index = index;
    return t;
  }
  int weight(const TimeJet<T>& w) {
    s_.weights[std::size_t(s_.weight_count)] = w;
    return s_.weight_count++;
  }

  void report(int node);
  void report_clip(int clip);

  const Graph& graph_;
  GraphBlock<T> block_;
  GraphScratch<T>& s_;
  EventSink* events_;
  T h_;
  int mirrored_ = 0;      ///< mirrors around what is emitted: they ask for both sides
  bool prelude_ = false;  ///< tasks belong to a change, at the start of the frame
};

template <class T>
bool Update<T>::may_interrupt(const GraphNode& node, const GraphMachineState<T>& m, int to) const {
  if (m.transition < 0) return true;
  const GraphTransition& running = node.transitions[std::size_t(m.transition)];
  if (running.interrupt != Interruption::kListed) return running.interrupt == Interruption::kAny;
  return std::find(running.interrupted_by.begin(), running.interrupted_by.end(), to) !=
         running.interrupted_by.end();
}

/// The first transition out of a state, or of a conduit on the way, that may be taken and leads somewhere.
template <class T>
bool Update<T>::follow(int index, const GraphMachineState<T>& m, int from, Choice& choice) const {
  const GraphNode& node = graph_.node(index);
  if (choice.count > GraphDefinition::kMostConduits) return false;
  GraphBlock<T> block = block_;
  for (std::size_t k = 0; k < node.transitions.size(); ++k) {
    const GraphTransition& t = node.transitions[k];
    const bool any = choice.count == 0 && t.from == GraphTransition::kAnyState && t.to != from;
    if (t.from != from && !any) continue;
    const bool conduit = node.states[std::size_t(t.to)].node < 0;
    if (!conduit && !may_interrupt(node, m, t.to)) continue;
    if (!holds(graph_, block, m, index, t)) continue;
    choice.legs[choice.count++] = static_cast<int>(k);
    choice.to = t.to;
    if (!conduit || follow(index, m, t.to, choice)) return true;
    --choice.count;
  }
  return false;
}

template <class T>
typename Update<T>::Choice Update<T>::choose(int index, const GraphMachineState<T>& m) const {
  Choice choice;
  if (!follow(index, m, m.state, choice)) choice.to = -1;
  return choice;
}

template <class T>
void Update<T>::use_up(const GraphNode& node, const Choice& choice) {
  for (int leg = 0; leg < choice.count; ++leg)
    for (const ConditionStep& step : node.transitions[std::size_t(choice.legs[leg])].condition)
      if (step.code == ConditionCode::kParameter &&
          graph_.definition().parameters[step.index].type == ParameterType::kTrigger)
        block_.parameter(step.index).goal = T(0);
}

template <class T>
void Update<T>::decide(int index) {
  const GraphNode& node = graph_.node(index);
  if (node.type != NodeType::kMachine) {
    for (const int child : node.children) decide(child);
    return;
  }
  const int slot = graph_.slot(index);
  GraphMachineState<T>& m = block_.machine(slot);
  if (const Choice choice = choose(index, m); choice.to >= 0)
    take(index, slot, choice);
  else
    decide(node.states[std::size_t(m.posed)].node);
}

template <class T>
void Update<T>::start_showing(GraphMachineState<T>& m, T target, T duration) {
  if (m.shown == target) return;
  // What the soft step is taken of, so that it goes on as it was.
  const TimeJet<T> now =
      TimeJet<T>(m.shown) + QuinticOffset<T>::at(m.shown_elapsed, m.shown_duration)(m.shown_from);
  m.shown_from = now - TimeJet<T>(target);
  m.shown = target;
  m.shown_elapsed = T(0);
  m.shown_duration = duration;
}

template <class T>
void Update<T>::leave(int index) {
  const GraphNode& node = graph_.node(index);
  if (node.type == NodeType::kClip) {
    const int clip = graph_.slot(index);
    const Graph::BoundClip& bound = graph_.clips()[std::size_t(clip)];
    const Clip& c = *bound.clip;
    const ClipTime time = clip_time(graph_, block_, clip);
    if (!events_ || block_.fresh(clip)) return;
    const int first = events_->count;
    end_events(bound.events(), double(c.duration), c.loops, time.value, time.rate < 0, *events_);
    for (int k = first; k < events_->count; ++k)
      events_->hits[std::size_t(k)].seconds_ago = static_cast<float>(h_);
    return;
  }
  if (node.type == NodeType::kMachine) {
    const GraphMachineState<T>& m = block_.machine(graph_.slot(index));
    if (m.source >= 0) leave(node.states[std::size_t(m.source)].node);
    return leave(node.states[std::size_t(m.posed)].node);
  }
  for (const int child : node.children) leave(child);
}

template <class T>
void Update<T>::take(int index, int slot, const Choice& choice) {
  const GraphNode& node = graph_.node(index);
  const int last = choice.legs[choice.count - 1];
  const GraphTransition& t = node.transitions[std::size_t(last)];
  GraphMachineState<T>& m = block_.machine(slot);
  use_up(node, choice);
  m.time = 0;
  m.transition = static_cast<std::int16_t>(last);
  m.state = static_cast<std::int16_t>(choice.to);
  const T duration = t.kind == TransitionKind::kCut ? T(0) : T(t.duration);
  const int next = node.states[std::size_t(choice.to)].node;
  if (graph_.node(next).type == NodeType::kEmpty) {
    if (!(duration > T(0)) && m.shown != T(0)) leave(node.states[std::size_t(m.posed)].node);
    return start_showing(m, T(0), duration);
  }

  const bool visible = !nothing(shown(m));
  start_showing(m, T(1), duration);
  const bool again = choice.to == m.posed;
  const bool crossfade = (t.kind == TransitionKind::kCrossfade || t.kind == TransitionKind::kSmoothstep) &&
                         m.fade == GraphFade::kNone && visible && !again;
  const bool offset = t.kind != TransitionKind::kCut && visible && !crossfade;
  if (offset) {  // what it does up to this instant
    prelude_ = true;
    emit(index, 0, TimeJet<T>(T(1)), true);
    const int kept = graph_.registers() - 1 - s_.change_count;
    task(GraphTask::Kind::kKeep, 0, slot).from = static_cast<std::uint16_t>(kept);
    s_.changes[std::size_t(s_.change_count++)] = {slot, kept};
    prelude_ = false;
  }
  if (!crossfade && visible) {
    if (m.source >= 0) leave(node.states[std::size_t(m.source)].node);
    leave(node.states[std::size_t(m.posed)].node);
  }
  m.source = crossfade ? m.posed : std::int16_t(-1);
  m.posed = static_cast<std::int16_t>(choice.to);
  m.fade = !crossfade && !offset                           ? GraphFade::kNone
           : !crossfade && t.kind == TransitionKind::kDead ? GraphFade::kLeft
           : !crossfade                                    ? GraphFade::kOffset
           : t.kind == TransitionKind::kSmoothstep         ? GraphFade::kSmoothstep
                                                           : GraphFade::kCrossfade;
  m.faded_by = last;
  m.elapsed = T(0);
  m.duration = duration;
  enter_node(graph_, block_, next, double(t.entry));
}

template <class T>
Status Update<T>::begin_offsets() {
  if (s_.change_count == 0) return {};
  prelude_ = true;
  for (int k = 0; k < s_.change_count; ++k) {
    const auto [slot, kept] = s_.changes[std::size_t(k)];
    const GraphMachineState<T>& m = block_.machine(slot);
    const GraphNode& node = graph_.node(graph_.machines()[std::size_t(slot)].node);
    const bool left = m.fade == GraphFade::kLeft;
    if (!left) emit(node.states[std::size_t(m.posed)].node, 0, TimeJet<T>(T(1)), false);
    GraphTask& begin = task(left ? GraphTask::Kind::kLeave : GraphTask::Kind::kBeginOffset, 0, slot);
    begin.from = static_cast<std::uint16_t>(kept);
    begin.layer = m.transition;  // which may be over before the frame is
  }
  const Status status = move_phases(0);
  s_.member_count = 0;
  prelude_ = false;
  return status;
}

template <class T>
void Update<T>::filter() {
  const auto& parameters = graph_.definition().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    GraphParameterState<T>& p = block_.parameter(static_cast<int>(k));
    if (parameters[k].type == ParameterType::kTrigger) {
      p.goal = std::max(T(0), p.goal - h_);
    } else if (parameters[k].half_life > 0 && parameters[k].type == ParameterType::kFloat) {
      SmoothInput<T> input{p.x};
      input.step(p.goal, SmoothInput<T>::pole_of(T(parameters[k].half_life)), h_);
      p.x = input.x;
    } else {
      p.x = TimeJet<T>(p.goal);
    }
  }
}

template <class T>
void Update<T>::advance_machine(int index) {
  const GraphNode& node = graph_.node(index);
  GraphMachineState<T>& m = block_.machine(graph_.slot(index));
  m.time += double(h_);
  m.elapsed += h_;
  if (m.elapsed >= m.duration) {
    if (m.source >= 0) leave(node.states[std::size_t(m.source)].node);
    m.source = -1;
    m.fade = GraphFade::kNone;
  }
  const bool fades_out = m.shown == T(0) && m.shown_elapsed < m.shown_duration;
  m.shown_elapsed = std::min(m.shown_elapsed + h_, m.shown_duration);
  if (fades_out && m.shown_elapsed == m.shown_duration) leave(node.states[std::size_t(m.posed)].node);
  if (!m.fading()) m.transition = -1;
  if (m.source >= 0) advance(node.states[std::size_t(m.source)].node);
  advance(node.states[std::size_t(m.posed)].node);
}

template <class T>
void Update<T>::advance(int index) {
  const GraphNode& node = graph_.node(index);
  if (node.type == NodeType::kMachine) return advance_machine(index);
  for (const int child : node.children) advance(child);
  if (node.type != NodeType::kClip) return;
  const int slot = graph_.slot(index);
  s_.shares[std::size_t(slot)] = -1;
  if (node.group >= 0) {
    block_.group(node.group).active = 1;
    return;
  }
  TimeJet<double>& played = block_.time(graph_.clips()[std::size_t(slot)].time);
  s_.before[std::size_t(slot)] = played_time(*graph_.clips()[std::size_t(slot)].clip, played).value;
  // exact to h⁵, as a phase is
  const TimeJet<double> speed = clip_speed(graph_, block_, node);
  const double h = double(h_);
  played.value += h / 2 * (played.rate + speed.value) + h * h / 12 * (played.acceleration - speed.rate);
  played.rate = speed.value;
  played.acceleration = speed.rate;
}

template <class T>
Status Update<T>::move_phases(double h) {
  for (int g = 0; g < static_cast<int>(graph_.definition().groups.size()); ++g) {
    std::size_t count = 0;
    for (int k = 0; k < s_.member_count; ++k) {
      const auto& member = s_.members[std::size_t(k)];
      if (member.group != g) continue;
      const Graph::BoundClip& clip = graph_.clips()[std::size_t(member.clip)];
      s_.phase_members[count++] = {&clip.map, member.weight, double(graph_.node(clip.node).speed.constant)};
    }
    TimeJet<double>& phase = block_.group(g).phase;
    if (count == 0) {
      phase.rate = phase.acceleration = 0;
      continue;
    }
    const PhaseJob job{{s_.phase_members.data(), count}, h, &phase, {s_.times.data(), count}};
    if (Status status = job.Run(); !status) return status;
    count = 0;
    for (int k = 0; k < s_.member_count; ++k) {
      const auto& member = s_.members[std::size_t(k)];
      if (member.group != g) continue;
      s_.now[std::size_t(member.clip)] = s_.times[count].value;
      s_.tasks[std::size_t(member.task)].time = s_.times[count++];
    }
  }
  return {};
}

template <class T>
void Update<T>::emit(int index, int base, const TimeJet<T>& weight, bool now) {
  switch (graph_.node(index).type) {
    case NodeType::kClip:
      return emit_clip(index, base, weight, now);
    case NodeType::kBlend:
      return emit_blend(index, base, weight, now);
    case NodeType::kLayers:
      return emit_layers(index, base, weight, now);
    case NodeType::kMachine:
      return emit_machine(index, base, weight, now);
    case NodeType::kEmpty:
      return;  // its layer shows nothing
    case NodeType::kPhysical:
      task(GraphTask::Kind::kPhysical, base, index);
      return;
    case NodeType::kMirror:
      ++mirrored_;
      emit(graph_.node(index).children.front(), base, weight, now);
      --mirrored_;
      task(GraphTask::Kind::kMirror, base, index);
      return;
    case NodeType::kTravel:
      return emit_single(GraphTask::Kind::kTravel, graph_.node(index).travel.weight, index, base, weight,
                         now);
    case NodeType::kFeet:
      return emit_single(GraphTask::Kind::kFeet, graph_.node(index).feet.weight, index, base, weight, now);
    case NodeType::kLook:
      return emit_single(GraphTask::Kind::kLook, graph_.node(index).look.weight, index, base, weight, now);
  }
}

/// A node that changes what its only child does, by a weight.
template <class T>
void Update<T>::emit_single(typename GraphTask::Kind kind, const GraphValue& how_much, int index, int base,
                            const TimeJet<T>& weight, bool now) {
  emit(graph_.node(index).children.front(), base, weight, now);
  GraphTask& t = task(kind, base, index);
  t.weights = this->weight(weight_of(block_, how_much));
}

template <class T>
void Update<T>::emit_clip(int index, int base, const TimeJet<T>& weight, bool now) {
  const GraphNode& node = graph_.node(index);
  const int slot = graph_.slot(index);
  GraphTask& t = task(GraphTask::Kind::kSample, base, slot);
  if (!prelude_) s_.shares[std::size_t(slot)] = static_cast<float>(weight.value);
  if (node.group < 0 || now) {
    t.time = clip_time(graph_, block_, slot);
    return;
  }
  s_.members[std::size_t(s_.member_count++)] = {
      s_.task_count - 1,
      slot,
      node.group,
      {std::max(0.0, double(weight.value)), double(weight.rate), double(weight.acceleration)}};
}

template <class T>
void Update<T>::emit_blend(int index, int base, const TimeJet<T>& weight, bool now) {
  const GraphNode& node = graph_.node(index);
  const int count = static_cast<int>(node.children.size());
  TimeJet<T> parameters[2], weights[BlendSpace::kMaxClips];
  const int dimensions = node.parameters[1] >= 0 ? 2 : 1;
  for (int d = 0; d < dimensions; ++d) parameters[d] = block_.parameter(node.parameters[d]).x;
  if (count == 1)
    weights[0] = TimeJet<T>(T(1));
  else
    blend_space_weights<T>(graph_.spaces()[std::size_t(graph_.slot(index))],
                           {parameters, std::size_t(dimensions)}, {weights, std::size_t(count)});
  int played = 0;
  for (int k = 0; k < count; ++k) {
    if (nothing(weights[k])) continue;
    weights[played] = weights[k];
    emit(node.children[std::size_t(k)], base + played, weight * weights[k], now);
    ++played;
  }
  if (played == 1) return;
  const int first = s_.weight_count;
  for (int k = 0; k < played; ++k) this->weight(weights[k]);
  GraphTask& t = task(GraphTask::Kind::kBlend, base, index);
  t.count = static_cast<std::uint16_t>(played);
  t.weights = first;
}

template <class T>
void Update<T>::emit_layers(int index, int base, const TimeJet<T>& weight, bool now) {
  const GraphNode& node = graph_.node(index);
  emit(node.children.front(), base, weight, now);
  for (std::size_t k = 0; k < node.layers.size(); ++k) {
    const int child = node.children[k + 1];
    TimeJet<T> w = weight_of(block_, node.layers[k].weight);
    if (graph_.node(child).type == NodeType::kMachine) w = w * shown(block_.machine(graph_.slot(child)));
    if (nothing(w)) continue;
    emit(child, base + 1, weight * w, now);
    GraphTask& t = task(GraphTask::Kind::kLayer, base, index);
    t.layer = static_cast<int>(k);
    t.weights = this->weight(w);
  }
}

template <class T>
void Update<T>::emit_machine(int index, int base, const TimeJet<T>& weight, bool now) {
  const GraphNode& node = graph_.node(index);
  const int slot = graph_.slot(index);
  const GraphMachineState<T>& m = block_.machine(slot);
  const int pose = node.states[std::size_t(m.posed)].node;
  if (m.fade == GraphFade::kCrossfade || m.fade == GraphFade::kSmoothstep) {
    const TimeJet<T> w = m.fade == GraphFade::kCrossfade ? EaseWeight<T>::at(m.elapsed, m.duration)
                                                         : smoothstep(m.elapsed, m.duration);
    emit(node.states[std::size_t(m.source)].node, base, weight * (TimeJet<T>(T(1)) - w), now);
    emit(pose, base + 1, weight * w, now);
    task(GraphTask::Kind::kCrossfade, base, slot).weights = this->weight(w);
    return;
  }
  emit(pose, base, weight, now);
  if (m.fade == GraphFade::kNone) return;
  GraphTask& t =
      task(m.fade == GraphFade::kLeft ? GraphTask::Kind::kLeft : GraphTask::Kind::kOffset, base, slot);
  t.time = ClipTime(double(m.elapsed), double(m.duration));
  t.layer = m.faded_by;
}

template <class T>
void Update<T>::report_clip(int slot) {
  const bool starts = block_.fresh(slot);
  if (starts) block_.set_fresh(slot, false);
  const float share = s_.shares[std::size_t(slot)];
  const Graph::BoundClip& bound = graph_.clips()[std::size_t(slot)];
  const Clip& c = *bound.clip;
  if (share < 0 || c.events.empty()) return;
  const std::span<EventHit> hits(s_.hits);  // conditions see events whether the game wants them or not
  EventSink sink{hits};
  const int group = graph_.node(bound.node).group;
  const double before =
      group < 0 ? s_.before[std::size_t(slot)] : bound.map.by_phase(s_.phases[std::size_t(group)]).value;
  const double now = group < 0 ? played_time(c, block_.time(bound.time)).value : s_.now[std::size_t(slot)];
  EventJob job{bound.events(), double(c.duration), c.loops, before, now, starts};
  job.step = static_cast<float>(h_);
  job.weight = share;
  job.out = &sink;
  if (!job.Run() && events_) ++events_->lost;  // a thousand loops in a frame
  for (int k = 0; k < sink.count; ++k) {
    block_.header().events |= graph_.event_bit(hits[std::size_t(k)].event->name);
    if (events_) events_->add(hits[std::size_t(k)]);
  }
  if (events_) events_->lost += sink.lost;
}

template <class T>
void Update<T>::report(int index) {
  const GraphNode& node = graph_.node(index);
  if (node.type == NodeType::kClip) return report_clip(graph_.slot(index));
  if (node.type == NodeType::kMachine) {
    const GraphMachineState<T>& m = block_.machine(graph_.slot(index));
    if (m.source >= 0) report(node.states[std::size_t(m.source)].node);
    return report(node.states[std::size_t(m.posed)].node);
  }
  for (const int child : node.children) report(child);
}

}  // namespace

template <class T>
Status GraphUpdateJob<T>::Validate() const {
  if (Status status = check_block<T>(graph, state, true); !status) return status;
  if (Status status = check_scratch(*graph, scratch); !status) return status;
  if (!std::isfinite(h)) return Status::error(Code::kNotFinite, "step is not finite");
  if (h < T(0) || h > T(1)) return Status::error(Code::kOutOfRange, "step is not within 0 and 1 s");
  return {};
}

template <class T>
Status GraphUpdateJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  return Update<T>(*this).run();
}

template struct GraphUpdateJob<float>;
template struct GraphUpdateJob<double>;

}  // namespace sinew
