// State machines against a slow interpreter of the same rules, and what a block of state must keep.
#include <functional>
#include <optional>

#include "fixtures/counting_new.h"
#include "graph_fixture.h"
#include "sinew/graph/graph_file.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

/// A machine with random states and transitions over three bools, two floats and two triggers. State 5 and 6
/// are conduits.
GraphDefinition random_machine(std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  GraphDefinition graph;
  graph.name = "random";
  for (int k = 0; k < 7; ++k) {
    GraphParameter& p = graph.parameters.emplace_back();
    p.name = "p" + std::to_string(k);
    p.type = k < 3 ? ParameterType::kBool : k < 5 ? ParameterType::kFloat : ParameterType::kTrigger;
    p.buffer = k == 5 ? 0.f : 0.1f;
  }
  GraphNode machine;
  machine.type = NodeType::kMachine;
  machine.name = "machine";
  constexpr int kStates = 7;
  for (int k = 0; k < kStates; ++k) {
    if (k >= 5) {
      machine.states.push_back({"conduit", -1});
      continue;
    }
    GraphNode& clip = graph.nodes.emplace_back();
    clip.name = "clip";
    clip.clip = k % 2 ? "hit" : "idle";
    machine.children.push_back(k);
    machine.states.push_back({"s", k});
  }
  const int transitions = 5 + below(12);
  for (int k = 0; k < transitions; ++k) {
    GraphTransition& t = machine.transitions.emplace_back();
    t.from = below(kStates + 1) - 1;
    t.to = below(kStates);
    if (t.from >= 5 && t.to == t.from) t.to = 0;
    t.kind = static_cast<TransitionKind>(below(4));
    t.duration = 0.05f * float(below(8));
    t.interrupt = static_cast<Interruption>(below(3));
    for (int s = 0; s < 5; ++s)
      if (below(2)) t.interrupted_by.push_back(s);
    // One to three terms, joined.
    const int terms = below(4);
    for (int n = 0; n < terms; ++n) {
      const auto index = static_cast<std::uint16_t>(below(7));
      t.condition.push_back({ConditionCode::kParameter, index, 0});
      if (index == 3 || index == 4) {
        t.condition.push_back({ConditionCode::kNumber, 0, float(below(3)) - 1});
        t.condition.push_back({below(2) ? ConditionCode::kLess : ConditionCode::kLessEqual, 0, 0});
      } else if (below(4) == 0) {
        t.condition.back() = {ConditionCode::kTime, 0, 0};
        t.condition.push_back({ConditionCode::kNumber, 0, 0.2f});
        t.condition.push_back({ConditionCode::kLess, 0, 0});
      }
      if (below(3) == 0) t.condition.push_back({ConditionCode::kNot, 0, 0});
      if (n > 0) t.condition.push_back({below(3) ? ConditionCode::kAnd : ConditionCode::kOr, 0, 0});
    }
  }
  graph.nodes.push_back(machine);
  return graph;
}

/// The rules of the page, as plainly as can be: everything is looked up by walking the definition, and a
/// condition is evaluated as the tree that it is.
class Interpreter {
 public:
  explicit Interpreter(const GraphDefinition& graph)
      : graph_(graph), m_(graph.nodes.back()), state(m_.start) {
    values.assign(graph.parameters.size(), 0);
  }

  void frame(float h) {
    if (const std::optional<std::vector<int>> legs = find(state, {}); legs) {
      const GraphTransition& last = m_.transitions[std::size_t(legs->back())];
      state = last.to;
      running = legs->back();
      time = 0;
      for (const int leg : *legs) use_up(m_.transitions[std::size_t(leg)]);
      left = last.kind == TransitionKind::kCut ? 0 : last.duration;
      // A cut, a crossfade or an offset alike runs for its duration.
      frames_elapsed = 0;
    }
    time += double(h);
    frames_elapsed += h;
    if (!(frames_elapsed < left)) running = -1;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (graph_.parameters[k].type == ParameterType::kTrigger) values[k] = std::max(0.f, values[k] - h);
  }

 private:
  using Path = std::vector<int>;
  std::optional<Path> find(int from, const Path& so_far) {
    if (so_far.size() > std::size_t(GraphDefinition::kMostConduits)) return {};
    for (std::size_t k = 0; k < m_.transitions.size(); ++k) {
      const GraphTransition& t = m_.transitions[k];
      if (t.from != from && !(so_far.empty() && t.from == -1 && t.to != from)) continue;
      if (!t.condition.empty()) {
        std::size_t end = t.condition.size();
        if (evaluate(t.condition, end) == 0) continue;
      }
      Path path = so_far;
      path.push_back(static_cast<int>(k));
      if (m_.states[std::size_t(t.to)].node < 0) {
        if (const auto further = find(t.to, path); further) return further;
        continue;
      }
      if (may_interrupt(t.to)) return path;
    }
    return {};
  }
  bool may_interrupt(int to) const {
    if (running < 0) return true;
    const GraphTransition& t = m_.transitions[std::size_t(running)];
    if (t.interrupt == Interruption::kAny) return true;
    if (t.interrupt == Interruption::kNever) return false;
    for (const int listed : t.interrupted_by)
      if (listed == to) return true;
    return false;
  }
  /// From the end of postfix towards its beginning.
  float evaluate(const std::vector<ConditionStep>& steps, std::size_t& end) {
    const ConditionStep& step = steps[--end];
    switch (step.code) {
      case ConditionCode::kNumber:
        return step.value;
      case ConditionCode::kParameter:
        return graph_.parameters[step.index].type == ParameterType::kTrigger ? float(values[step.index] > 0)
                                                                             : values[step.index];
      case ConditionCode::kTime:
        return static_cast<float>(time);
      case ConditionCode::kNot:
        return evaluate(steps, end) == 0 ? 1 : 0;
      default:
        break;
    }
    const float b = evaluate(steps, end), a = evaluate(steps, end);
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
  const GraphNode& m_;

 public:
  std::vector<float> values;  ///< of triggers what is left of their buffer
  int state = 0, running = -1;
  double time = 0;
  float left = 0, frames_elapsed = 0;
};

TEST(GraphMachine, AMillionRandomFramesGoAsASlowInterpreterSays) {
  const Asset asset = fixtures::graph_asset();
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  long frames = 0, changes = 0;
  while (frames < 1'000'000) {
    const GraphDefinition definition = random_machine(random);
    Graph graph;
    ASSERT_TRUE(Graph::bind(definition, asset, graph).ok());
    GraphPlayer<float> player(graph);
    Interpreter slow(definition);
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
      const int was = slow.state;
      player.update(double(h));
      slow.frame(h);
      changes += was != slow.state;
      ASSERT_EQ(parameters.state(graph.root()), slow.state) << "frame " << frames;
      ASSERT_EQ(parameters.fading(graph.root()), slow.running >= 0) << "frame " << frames;
    }
  }
  EXPECT_GT(changes, 50'000);
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
