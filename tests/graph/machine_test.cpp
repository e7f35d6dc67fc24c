// State machines against a slow interpreter of the same rules, and what a block of state must keep.
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "fixtures/counting_new.h"
#include "graph_fixture.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/event_job.h"
#include "sinew/graph/graph_file.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

/// One to three terms, joined, over three bools, two floats, two triggers, the time and an event.
std::vector<ConditionStep> random_condition(std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  std::vector<ConditionStep> out;
  const int terms = below(4);
  for (int n = 0; n < terms; ++n) {
    const auto index = static_cast<std::uint16_t>(below(7));
    out.push_back({ConditionCode::kParameter, index, 0});
    const int other = below(8);
    if (index == 3 || index == 4) {
      out.push_back({ConditionCode::kNumber, 0, float(below(3)) - 1});
      out.push_back({below(2) ? ConditionCode::kLess : ConditionCode::kLessEqual, 0, 0});
    } else if (other < 2) {
      out.back() = {ConditionCode::kTime, 0, 0};
      out.push_back({ConditionCode::kNumber, 0, 0.2f});
      out.push_back({ConditionCode::kLess, 0, 0});
    } else if (other == 2) {
      out.back() = {ConditionCode::kEvent, static_cast<std::uint16_t>(below(2)), 0};
    } else if (other == 3) {
      out.back() = {ConditionCode::kFading, 0, 0};
    }
    if (below(3) == 0) out.push_back({ConditionCode::kNot, 0, 0});
    if (n > 0) out.push_back({below(3) ? ConditionCode::kAnd : ConditionCode::kOr, 0, 0});
  }
  return out;
}

/// A machine over nodes that are there, and two conduits, with random transitions. Returns its index.
int add_machine(std::mt19937& random, const std::vector<int>& nodes, GraphDefinition& graph) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  GraphNode machine;
  machine.type = NodeType::kMachine;
  machine.name = "machine";
  machine.children = nodes;
  for (const int node : nodes) machine.states.push_back({"s", node});
  machine.states.insert(machine.states.end(), 2, {"conduit", -1});
  const int states = static_cast<int>(machine.states.size());
  const int transitions = 5 + below(12);
  for (int k = 0; k < transitions; ++k) {
    GraphTransition& t = machine.transitions.emplace_back();
    t.from = below(states + 1) - 1;
    t.to = below(states);
    if (t.from >= states - 2 && t.to == t.from) t.to = 0;
    t.kind = static_cast<TransitionKind>(below(5));
    t.duration = 0.05f * float(below(8));
    t.entry = below(3) ? 0 : 0.7f;
    t.interrupt = static_cast<Interruption>(below(3));
    for (int s = 0; s < states - 2; ++s)
      if (below(2)) t.interrupted_by.push_back(s);
    t.condition = random_condition(random);
  }
  graph.nodes.push_back(machine);
  return static_cast<int>(graph.nodes.size()) - 1;
}

/// Two machines, one laid upon the other; states of the lower one are a machine with a machine in it.
GraphDefinition random_machines(std::mt19937& random) {
  GraphDefinition graph;
  graph.name = "random";
  graph.events = {"step", "helpless"};
  for (int k = 0; k < 7; ++k) {
    GraphParameter& p = graph.parameters.emplace_back();
    p.name = "p" + std::to_string(k);
    p.type = k < 3 ? ParameterType::kBool : k < 5 ? ParameterType::kFloat : ParameterType::kTrigger;
    p.buffer = k == 5 ? 0.f : 0.1f;
  }
  const auto clips = [&](std::initializer_list<const char*> names) {
    std::vector<int> out;
    for (const char* name : names) {
      GraphNode& clip = graph.nodes.emplace_back();
      clip.name = "clip";
      clip.clip = name;
      out.push_back(static_cast<int>(graph.nodes.size()) - 1);
    }
    return out;
  };
  std::vector<int> middle = clips({"rise", "walk"});
  middle.push_back(add_machine(random, clips({"walk", "rise"}), graph));
  std::vector<int> lower = clips({"idle", "walk", "rise", "run"});
  lower.push_back(add_machine(random, middle, graph));
  const int base = add_machine(random, lower, graph);
  const int upper = add_machine(random, clips({"rise", "hit", "run"}), graph);
  GraphNode root;
  root.type = NodeType::kLayers;
  root.name = "graph";
  root.children = {base, upper};
  root.layers.resize(1);
  graph.nodes.push_back(root);
  return graph;
}

/// What a frame passed of a clip.
struct Passed {
  std::uint32_t name;
  EventKind kind;
  float seconds_ago;

  bool operator<(const Passed& other) const {
    return std::tie(name, kind, seconds_ago) < std::tie(other.name, other.kind, other.seconds_ago);
  }
};

/// The rules of the page, as plainly as can be: everything is looked up by walking the definition, a
/// condition is evaluated as the tree that it is, and events are looked for in all passes of their clips.
class Interpreter {
 public:
  struct Machine {
    int state = 0, source = -1, running = -1;
    double time = 0;
    float elapsed = 0, duration = 0;
    bool fades = false;
    TransitionKind kind = TransitionKind::kCut;  ///< of the transition that made it fade
  };

  Interpreter(const GraphDefinition& graph, const Asset& asset) : graph_(graph), asset_(asset) {
    values.assign(graph.parameters.size(), 0);
    enter(root(), 0);
  }

  void frame(float h) {
    passed.clear();
    h_ = h;
    decide(root());
    for (std::size_t k = 0; k < values.size(); ++k)
      if (graph_.parameters[k].type == ParameterType::kTrigger) values[k] = std::max(0.f, values[k] - h);
    advance(root());
    names_.clear();
    report(root(), 1);
  }

  std::vector<float> values;        ///< of triggers what is left of their buffer
  std::map<int, Machine> machines;  ///< [node]
  std::vector<Passed> passed;       ///< in this frame

 private:
  using Path = std::vector<int>;
  struct Played {
    double before = 0, now = 0;
    bool fresh = true;
  };

  int root() const { return static_cast<int>(graph_.nodes.size()) - 1; }
  const GraphNode& node(int n) const { return graph_.nodes[std::size_t(n)]; }
  const Clip& clip(int n) const { return asset_.clips[std::size_t(asset_.find_clip(node(n).clip))]; }
  int shown(int n, int state) const { return node(n).states[std::size_t(state)].node; }
  /// Those that play below a node that does.
  std::vector<int> playing(int n) const {
    if (node(n).type != NodeType::kMachine) return node(n).children;
    const Machine& m = machines.at(n);
    std::vector<int> out;
    if (m.source >= 0) out.push_back(shown(n, m.source));
    out.push_back(shown(n, m.state));
    return out;
  }

  void enter(int n, double entry) {
    if (node(n).type == NodeType::kClip) clips_[n] = {entry, entry, true};
    if (node(n).type == NodeType::kMachine) {
      machines[n] = {};
      machines[n].state = node(n).start;
      return enter(shown(n, node(n).start), entry);
    }
    for (const int child : node(n).children) enter(child, entry);
  }
  void leave(int n) {
    for (const int below : playing(n)) leave(below);
    if (node(n).type != NodeType::kClip || clips_[n].fresh) return;
    for (const ClipEvent& e : clip(n).events)  // none of a part is in a loop
      if (e.begin < e.end && double(e.begin) <= clips_[n].now && clips_[n].now < double(e.end))
        passed.push_back({e.name, EventKind::kEnd, h_});
  }
  void decide(int n) {
    if (node(n).type == NodeType::kMachine) {
      if (const std::optional<Path> path = find(n, machines[n].state, {}); path) return take(n, *path);
      return decide(shown(n, machines[n].state));
    }
    for (const int child : node(n).children) decide(child);
  }
  void take(int n, const Path& path) {
    Machine& m = machines[n];
    const GraphTransition& last = node(n).transitions[std::size_t(path.back())];
    for (const int leg : path) use_up(node(n).transitions[std::size_t(leg)]);
    const bool cuts = last.kind == TransitionKind::kCut;
    const bool both = (last.kind == TransitionKind::kCrossfade || last.kind == TransitionKind::kSmoothstep) &&
                      !m.fades && last.to != m.state;
    if (!both) leave_all(n);
    m.source = both ? m.state : -1;
    m.state = last.to;
    m.running = path.back();
    m.time = 0;
    m.elapsed = 0;
    m.duration = cuts ? 0 : last.duration;
    m.fades = !cuts;
    m.kind = last.kind;
    enter(shown(n, m.state), double(last.entry));
  }
  void leave_all(int n) {
    for (const int below : playing(n)) leave(below);
  }
  void advance(int n) {
    if (node(n).type == NodeType::kClip) {
      clips_[n].before = clips_[n].now;
      clips_[n].now += double(h_);
    }
    if (node(n).type == NodeType::kMachine) {
      Machine& m = machines[n];
      m.time += double(h_);
      m.elapsed += h_;
      if (m.elapsed >= m.duration) {
        if (m.source >= 0) leave(shown(n, m.source));
        m.source = m.running = -1;
        m.fades = false;
      }
    }
    for (const int below : playing(n)) advance(below);
  }
  /// How much of what a machine shows is the state gone to, while both play.
  static float share(const Machine& m) {
    if (m.kind == TransitionKind::kCrossfade) return EaseWeight<float>::at(m.elapsed, m.duration).value;
    const float u = m.elapsed / m.duration;
    return u * u * (3 - 2 * u);
  }
  void report(int n, float weight) {
    if (node(n).type == NodeType::kMachine) {
      const Machine& m = machines.at(n);
      const float to = m.source >= 0 ? share(m) : 1;
      if (m.source >= 0) report(shown(n, m.source), weight * (1 - to));
      return report(shown(n, m.state), weight * to);
    }
    for (const int below : node(n).children) report(below, weight);
    if (node(n).type != NodeType::kClip) return;
    for (const ClipEvent& e : clip(n).events) {
      const EventKind begins = e.begin < e.end ? EventKind::kBegin : EventKind::kInstant;
      if (weight >= EventJob().threshold) pass(n, double(e.begin), {e.name, begins, 0});
      if (e.begin < e.end) pass(n, double(e.end), {e.name, EventKind::kEnd, 0});
    }
    clips_[n].fresh = false;
  }
  void pass(int n, double first, Passed event) {
    const Played& at = clips_[n];
    const double duration = double(clip(n).duration);
    const int passes = clip(n).loops ? 1 + static_cast<int>(at.now / duration) : 0;
    for (int k = clip(n).loops ? -1 : 0; k <= passes; ++k) {
      const double when = first + k * duration;
      if (when > at.now || when < at.before || (when == at.before && !at.fresh)) continue;
      event.seconds_ago = static_cast<float>(at.now - when);
      passed.push_back(event);
      names_.insert(event.name);
    }
  }

  std::optional<Path> find(int n, int from, const Path& so_far) {
    if (so_far.size() > std::size_t(GraphDefinition::kMostConduits)) return {};
    const GraphNode& machine = node(n);
    for (std::size_t k = 0; k < machine.transitions.size(); ++k) {
      const GraphTransition& t = machine.transitions[k];
      if (t.from != from && !(so_far.empty() && t.from == -1 && t.to != from)) continue;
      if (!t.condition.empty()) {
        std::size_t end = t.condition.size();
        if (evaluate(machines[n], t.condition, end) == 0) continue;
      }
      Path path = so_far;
      path.push_back(static_cast<int>(k));
      if (machine.states[std::size_t(t.to)].node < 0) {
        if (const auto further = find(n, t.to, path); further) return further;
        continue;
      }
      if (may_interrupt(n, t.to)) return path;
    }
    return {};
  }
  bool may_interrupt(int n, int to) {
    const int running = machines[n].running;
    if (running < 0) return true;
    const GraphTransition& t = node(n).transitions[std::size_t(running)];
    if (t.interrupt == Interruption::kAny) return true;
    if (t.interrupt == Interruption::kNever) return false;
    for (const int listed : t.interrupted_by)
      if (listed == to) return true;
    return false;
  }
  /// From the end of postfix towards its beginning.
  float evaluate(const Machine& m, const std::vector<ConditionStep>& steps, std::size_t& end) {
    const ConditionStep& step = steps[--end];
    switch (step.code) {
      case ConditionCode::kNumber:
        return step.value;
      case ConditionCode::kParameter:
        return graph_.parameters[step.index].type == ParameterType::kTrigger ? float(values[step.index] > 0)
                                                                             : values[step.index];
      case ConditionCode::kTime:
        return static_cast<float>(m.time);
      case ConditionCode::kEvent:
        return float(names_.count(event_name(graph_.events[step.index])));
      case ConditionCode::kFading:
        return float(m.running >= 0);
      case ConditionCode::kNot:
        return evaluate(m, steps, end) == 0 ? 1 : 0;
      default:
        break;
    }
    const float b = evaluate(m, steps, end), a = evaluate(m, steps, end);
    if (step.code == ConditionCode::kLess) return a < b ? 1 : 0;
    if (step.code == ConditionCode::kLessEqual) return a <= b ? 1 : 0;
    if (step.code == ConditionCode::kAnd) return a != 0 && b != 0 ? 1 : 0;
    return a != 0 || b != 0 ? 1 : 0;
  }
  void use_up(const GraphTransition& t) {
    for (const ConditionStep& step : t.condition)
      if (step.code == ConditionCode::kParameter &&
          graph_.parameters[step.index].type == ParameterType::kTrigger)
        values[step.index] = 0;
  }

  const GraphDefinition& graph_;
  const Asset& asset_;
  std::map<int, Played> clips_;    ///< [node]
  std::set<std::uint32_t> names_;  ///< of events that the frame before passed
  float h_ = 0;
};

/// Both as sets: of what is passed at one time the order is left open.
void expect_same_events(const GraphPlayer<float>& player, std::vector<Passed> slow) {
  std::vector<Passed> fast;
  for (int e = 0; e < player.events.count; ++e) {
    const EventHit& hit = player.hits[std::size_t(e)];
    fast.push_back({hit.event->name, hit.kind, hit.seconds_ago});
  }
  ASSERT_EQ(player.events.lost, 0);
  std::sort(fast.begin(), fast.end());
  std::sort(slow.begin(), slow.end());
  const auto shown = [](const std::vector<Passed>& all) {
    std::string out;
    for (const Passed& p : all)
      out += " " + std::to_string(p.name) + "/" + std::to_string(int(p.kind)) + "/" +
             std::to_string(p.seconds_ago);
    return out;
  };
  ASSERT_EQ(fast.size(), slow.size()) << "fast:" << shown(fast) << "\nslow:" << shown(slow);
  for (std::size_t e = 0; e < fast.size(); ++e) {
    ASSERT_EQ(fast[e].name, slow[e].name);
    ASSERT_EQ(fast[e].kind, slow[e].kind);
    ASSERT_NEAR(fast[e].seconds_ago, slow[e].seconds_ago, 1e-5);
  }
}

TEST(GraphMachine, AMillionRandomFramesGoAsASlowInterpreterSays) {
  const Asset asset = fixtures::graph_asset();
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  long frames = 0, changes = 0, events = 0, nested = 0;
  while (frames < 1'000'000) {
    const GraphDefinition definition = random_machines(random);
    Graph graph;
    ASSERT_TRUE(Graph::bind(definition, asset, graph).ok());
    GraphPlayer<float> player(graph);
    Interpreter slow(definition, asset);
    GraphParameters<float> parameters(graph, player.state);
    for (int k = 0; k < 2000; ++k, ++frames) {
      if (uniform(random) < 0.3f) {
        const int p = std::uniform_int_distribution<int>(0, 6)(random);
        const float v = p < 3 ? float(uniform(random) < 0.5f) : std::floor(3 * uniform(random)) - 1;
        if (p < 5) {
          ASSERT_TRUE(parameters.set(p, v).ok());
          slow.values[std::size_t(p)] = v;
        } else {
          ASSERT_TRUE(parameters.trigger(p).ok());
          slow.values[std::size_t(p)] = definition.parameters[std::size_t(p)].buffer + 1e-6f;
        }
      }
      const float h = uniform(random) < 0.5f ? 1 / 60.f : 0.05f * uniform(random);
      const std::map<int, Interpreter::Machine> were = slow.machines;
      player.update(double(h));
      slow.frame(h);
      for (const auto& [node, machine] : slow.machines) {
        ASSERT_EQ(parameters.state(node), machine.state) << "frame " << frames << ", node " << node;
        ASSERT_EQ(parameters.fading(node), machine.running >= 0) << "frame " << frames << ", node " << node;
        const bool changed = were.count(node) && were.at(node).state != machine.state;
        changes += changed;
        nested += changed && node < definition.nodes.back().children[0];
      }
      ASSERT_NO_FATAL_FAILURE(expect_same_events(player, slow.passed)) << "frame " << frames;
      events += player.events.count;
    }
  }
  EXPECT_GT(changes, 100'000);
  EXPECT_GT(nested, 10'000);
  EXPECT_GT(events, 200'000);
}

TEST(GraphMachine, TheBlockIsTheWholeState) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  GraphPlayer<float> player(graph), other(graph);
  player.step(0);
  player.set("speed", 2);
  player.set("wave", 1);
  for (int k = 0; k < 30; ++k) player.step(1 / 60.0);
  player.trigger("hit");
  player.set("lean", 1);
  for (int k = 0; k < 5; ++k) player.step(1 / 60.0);  // within a transition
  const std::vector<std::byte> saved = player.state;
  std::vector<std::vector<JointJet<float>>> shown;
  const auto play = [&](GraphPlayer<float>& p, int k) {
    if (k == 100) p.trigger("rise");
    if (k == 110) p.trigger("dead");
    if (k == 300) p.set("speed", 3);
    p.step(1 / 60.0);
  };
  for (int k = 0; k < 600; ++k) {
    play(player, k);
    shown.push_back(player.jets);
  }
  for (int k = 0; k < 50; ++k) other.step(0.01);  // its scratch has seen something else
  other.state = saved;
  for (int k = 0; k < 600; ++k) {
    play(other, k);
    for (std::size_t j = 0; j < other.jets.size(); ++j) {
      const JointJet<float>&a = other.jets[j], &b = shown[std::size_t(k)][j];
      ASSERT_TRUE(a.rotation.coeffs() == b.rotation.coeffs() && a.omega == b.omega && a.alpha == b.alpha &&
                  a.translation == b.translation && a.velocity == b.velocity &&
                  a.acceleration == b.acceleration)
          << "frame " << k << ", joint " << j;
    }
  }
  EXPECT_EQ(other.state, player.state);
}

TEST(GraphMachine, PlayingTakesNothingFromTheHeap) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  GraphPlayer<float> player(graph);
  const long start = fixtures::allocations;
  bool ok = true;
  GraphParameters<float> parameters(graph, player.state);
  const int speed = 0, wave = 4, hit = 5, rise = 6;
  for (int k = 0; k < 600; ++k) {
    if (k % 50 == 10) ok &= parameters.set(speed, float(k % 4)).ok();
    if (k % 70 == 20) ok &= parameters.set(wave, float(k % 2)).ok();
    if (k % 90 == 30) ok &= parameters.trigger(hit).ok();
    if (k % 130 == 40) ok &= parameters.trigger(rise).ok();
    ok &= GraphUpdateJob<float>{&graph, player.state, 1 / 60.f, &player.scratch, &player.events}.Run().ok();
    ok &= GraphPoseJob<float>{&graph, player.state, &player.scratch, player.jets, player.curves}.Run().ok();
    player.events.count = 0;
  }
  EXPECT_EQ(fixtures::allocations - start, 0);
  EXPECT_TRUE(ok);
}

TEST(GraphMachine, TransitionsTakenTakeWhatTheyWaitedFor) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(
      R"({"parameters": {"jump": "trigger", "late": {"type": "trigger", "buffer": 0}, "free": true},
    "graph": {"states": {"a": "idle", "b": "walk", "c": "run", "gate": {"conduit": true}},
      "transitions": [{"from": "a", "to": "b", "if": "jump && free"}, {"from": "b", "to": "c", "if": "jump"},
                      {"from": "c", "to": "gate", "if": "late"}, {"from": "gate", "to": "a", "if": "!free"}]}})",
      asset, graph);
  GraphPlayer<float> player(graph);
  player.step(0);
  player.trigger("jump");
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "b") << "one press, one jump";
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "b") << "used up";
  player.trigger("jump");
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "c");
  player.trigger("late");
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "c") << "a conduit without a way out is not entered";
  player.set("free", 0);
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "c") << "without a buffer a press is forgotten after a frame";
  player.trigger("late");
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "a");
  player.trigger("jump");
  for (int k = 0; k < 12; ++k) player.step(0.01);
  player.set("free", 1);
  player.step(0.01);
  EXPECT_EQ(player.in("graph"), "b") << "waited for 0.12 s of 0.15";
}

TEST(GraphMachine, WhatOpensTheWayToAConduitIsUsedUpToo) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"parameters": {"jump": "trigger"}, "graph": {
    "states": {"a": "idle", "b": "walk", "c": "run", "gate": {"conduit": true}},
    "transitions": [{"from": "a", "to": "gate", "if": "jump"}, {"from": "gate", "to": "b"},
                    {"from": "b", "to": "c", "if": "jump"}]}})",
                       asset, graph);
  GraphPlayer<float> player(graph);
  player.step(0);
  player.trigger("jump");
  for (int k = 0; k < 5; ++k) player.step(0.01);
  EXPECT_EQ(player.in("graph"), "b") << "one press, one jump";
}

TEST(GraphMachine, ATransitionShorterThanAFrameIsOverAtItsEnd) {
  const Asset asset = fixtures::graph_asset();
  for (const char* kind : {"inertial", "dead", "crossfade"}) {
    Graph graph;
    fixtures::bind_graph(R"({"parameters": {"go": false}, "graph": {"states": {"a": "idle", "b": "lean"},
      "transitions": [{"from": "a", "to": "b", "if": "go", "duration": 0.001, "kind": ")" +
                             std::string(kind) + R"("}]}})",
                         asset, graph);
    GraphPlayer<float> player(graph);
    player.step(0);
    player.set("go", 1);
    player.step(1 / 60.0);
    EXPECT_EQ(player.in("graph"), "b");
    EXPECT_FALSE(GraphParameters<float>(graph, player.state).fading(graph.root())) << kind;
    std::vector<JointJet<float>> clip(fixtures::kGraphJoints);
    ASSERT_TRUE((SamplingJob<float>{&asset.clips[5], double(1 / 60.f), clip}.Run().ok()));
    for (std::size_t j = 1; j < clip.size(); ++j)
      EXPECT_LT((clip[j].omega - player.jets[j].omega).norm(), 1e-4f) << kind << " " << j;
  }
}

TEST(GraphMachine, WrongUseIsAStatus) {
  const Asset asset = fixtures::graph_asset();
  Graph graph, other;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  fixtures::bind_graph(R"({"graph": "walk"})", asset, other);
  GraphPlayer<float> player(graph);
  GraphScratch<float> scratch(other);
  const auto update = [&](const Graph* g, std::span<std::byte> state, float h, GraphScratch<float>* s) {
    return GraphUpdateJob<float>{g, state, h, s}.Run();
  };
  EXPECT_FALSE(update(nullptr, player.state, 0, &player.scratch).ok());
  EXPECT_FALSE(update(&graph, player.state, 0, nullptr).ok());
  EXPECT_FALSE(update(&graph, player.state, 0, &scratch).ok());
  EXPECT_FALSE(update(&graph, player.state, -0.1f, &player.scratch).ok());
  EXPECT_FALSE(update(&graph, player.state, NAN, &player.scratch).ok());
  EXPECT_FALSE(update(&graph, std::span(player.state).subspan(16), 0, &player.scratch).ok());
  GraphMemory fresh(graph.state_bytes<float>());
  EXPECT_FALSE(update(&graph, fresh, 0, &player.scratch).ok()) << "not started";
  GraphParameters<float> parameters(graph, player.state);
  EXPECT_FALSE(parameters.set(-1, 0).ok());
  EXPECT_FALSE(parameters.set(0, NAN).ok());
  EXPECT_FALSE(parameters.set(5, 1).ok()) << "a trigger is no number";
  EXPECT_FALSE(parameters.trigger(0).ok());
  EXPECT_FALSE(parameters.trigger(99).ok());
  EXPECT_EQ(parameters.state(-1), -1);
  EXPECT_EQ(parameters.state(0), -1) << "a clip has no state";
  EXPECT_TRUE(update(&graph, player.state, 0, &player.scratch).ok());
  GraphPoseJob<float> pose{&graph, player.state, &player.scratch, {}};
  EXPECT_FALSE(pose.Run().ok()) << "no joints";
  Graph physical;
  fixtures::bind_graph(R"({"graph": {"physical": true}})", asset, physical);
  GraphPlayer<float> limp(physical);
  limp.update(0);
  EXPECT_FALSE((GraphPoseJob<float>{&physical, limp.state, &limp.scratch, limp.jets}.Run().ok()));
}

}  // namespace
}  // namespace sinew
