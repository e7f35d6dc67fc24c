// A small asset, graphs written as JSON, and a player that keeps its state where a test can copy it.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "fixtures/clips.h"
#include "graph/compile.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/graph/graph_step.h"

namespace sinew::fixtures {

constexpr int kGraphJoints = 11;

/// Loops "walk" and "run" with markers and steps, "idle" without, one-shots "hit" and "rise" with a part, and
/// "lean" for layers. Knots are half a second apart, so that differences of poses are exact.
inline Asset graph_asset() {
  Asset asset;
  for (int j = 0; j < kGraphJoints; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    // As random_clip() has them, to the bit: joints that clips do not move are where they rest.
    joint.rest.translation = Vec3<float>(0.01f * float(j), 0.02f, 0.3f).cast<double>();
    asset.skeleton.joints.push_back(joint);
  }
  unsigned seed = 1;
  const auto add = [&](const std::string& name, float duration, bool loops) -> Clip& {
    asset.clips.push_back(random_clip({.joints = kGraphJoints,
                                       .duration = duration,
                                       .knot_interval = 0.5f,
                                       .loops = loops,
                                       .moving = 1,
                                       .seed = seed++}));
    Clip& clip = asset.clips.back();
    clip.name = name;
    // Roots turn within half a radian: upside down a heading means nothing.
    Clip::Group& turns = clip.groups[0];
    for (std::size_t k = 0; k < turns.controls.size(); k += 4 * turns.tracks.size()) {
      Eigen::Map<Quat<float>> q(turns.controls.data() + k);
      q = Quat<float>::Identity().slerp(0.3f, q);
    }
    return clip;
  };
  add("idle", 3, true);
  Clip& walk = add("walk", 2, true);
  walk.root_step = {3, 0.5f, 0};
  walk.markers = {{0, 0.1}, {0.5, 1.0}};
  Clip& run = add("run", 1.5f, true);
  run.root_step = {5, 0, 0};
  run.markers = {{0, 0.7}, {0.5, 1.5}};
  add("hit", 1, false);
  add("rise", 2.5f, false);
  add("lean", 2, true);
  asset.event_names = {"step", "helpless"};
  const auto event = [](const char* name, float from, float to) {
    ClipEvent e;
    e.name = event_name(name);
    e.begin = from;
    e.end = to;
    return e;
  };
  asset.clips[1].events = {event("step", 0.1f, 0.1f), event("step", 1, 1)};
  asset.clips[2].events = {event("step", 0.7f, 0.7f), event("step", 1.5f, 1.5f)};
  asset.clips[4].events = {event("helpless", 0.2f, 1.5f)};
  asset.curve_slots = {{"strength", 1}};
  asset.clips[3].curves = {{0, 0.5f, {0.2f, 0.4f, 0.9f, 0.3f, 0.7f}}};
  asset.masks = {{"upper", {0, 0, 0, 0, 128, 255, 255, 255, 255, 255, 255}}};
  return asset;
}

/// Compiles and binds; a fault fails the test.
inline void bind_graph(const std::string& json, const Asset& asset, Graph& out) {
  const graph_tools::Compiled compiled = graph_tools::compile_graph(json, "test");
  ASSERT_EQ(compiled.error, "");
  ASSERT_EQ(graph_tools::bind_fault(compiled, "test", asset), "");
  ASSERT_TRUE(Graph::bind(compiled.graph, asset, out).ok());
}

template <class T>
struct GraphPlayer {
  const Graph& graph;
  GraphScratch<T> scratch{graph};
  std::vector<std::byte> state = std::vector<std::byte>(graph.state_bytes<T>());
  std::vector<JointJet<T>> jets = std::vector<JointJet<T>>(std::size_t(graph.joint_count()));
  std::vector<TimeJet<T>> curves = std::vector<TimeJet<T>>(std::size_t(graph.curve_count()));
  std::vector<JointJet<T>> physical = jets;
  std::vector<EventHit> hits = std::vector<EventHit>(64);
  EventSink events{hits};
  GraphGround<T> ground;

  explicit GraphPlayer(const Graph& played) : graph(played) {
    EXPECT_TRUE(start_graph<T>(graph, state).ok());
  }
  GraphPlayer(const GraphPlayer&) = delete;

  int parameter(const char* name) const { return graph.definition().find_parameter(name); }
  void set(const char* name, double value) {
    EXPECT_TRUE(GraphParameters<T>(graph, state).set(parameter(name), T(value)).ok()) << name;
  }
  void trigger(const char* name) {
    EXPECT_TRUE(GraphParameters<T>(graph, state).trigger(parameter(name)).ok()) << name;
  }
  void update(double h) {
    events.count = events.lost = 0;
    const Status status = GraphUpdateJob<T>{&graph, state, T(h), &scratch, &events}.Run();
    EXPECT_TRUE(status.ok()) << status.reason;
  }
  void step(double h) {
    events.count = events.lost = 0;
    const Status status =
        GraphStepJob<T>{&graph, state, T(h), &scratch, jets, &events, curves, physical, {}, ground}.Run();
    EXPECT_TRUE(status.ok()) << status.reason;
  }
  /// Name of the state of the machine of this name.
  std::string in(const char* machine) {
    for (const Graph::BoundMachine& m : graph.machines())
      if (graph.node(m.node).name == machine)
        return graph.node(m.node).states[std::size_t(GraphParameters<T>(graph, state).state(m.node))].name;
    return "no machine";
  }
};

/// Every kind of node and of smooth transition.
inline const char* kSmoothGraph = R"({
  "parameters": {
    "speed": {"value": 0, "filter": 0.15}, "pace": {"value": 1, "filter": 0.1}, "side": {"filter": 0.2},
    "lean": {"filter": 0.1}, "wave": false, "hit": "trigger", "rise": "trigger", "dead": "trigger"
  },
  "nodes": {
    "move": {"blend": "speed", "sync": "feet", "points": [[0, {"clip": "idle", "sync": null}], [1.5, "walk"], [3.3, "run"]]},
    "plane": {"blend": ["speed", "side"], "points": [[0, 0, "idle"], [3, 0, {"clip": "lean", "speed": "pace"}], [0, 3, "hit"]]}
  },
  "graph": {"layers": [
    {
      "states": {"move": "move", "plane": "plane", "hit": "hit", "rise": {"clip": "rise", "speed": "pace"},
                 "other": {"mirror": {"blend": "speed", "points": [[0, "lean"], [2, "walk"]]}}},
      "transitions": [
        {"from": "hit", "to": "other", "if": "rise", "duration": 0.2},
        {"from": "other", "to": "move", "if": "time > 0.8", "duration": 0.3},
        {"from": "*", "to": "hit", "if": "hit", "duration": 0.3, "profile": "upper", "share": 0.5},
        {"from": ["hit", "rise"], "to": "move", "if": "remaining < 0.2 && !fading", "duration": 0.25},
        {"from": "*", "to": "rise", "if": "rise", "kind": "crossfade", "duration": 0.5},
        {"from": "*", "to": "plane", "if": "dead", "kind": "dead", "duration": 0.4},
        {"from": "plane", "to": "move", "if": "time > 1.5", "kind": "crossfade", "duration": 0.4}
      ]
    },
    {
      "node": {
        "states": {"none": null, "wave": "lean", "point": "idle"},
        "transitions": [
          {"from": "none", "to": "wave", "if": "wave", "duration": 0.4},
          {"from": "*", "to": "none", "if": "!wave", "duration": 0.3},
          {"from": "wave", "to": "point", "if": "time > 1", "duration": 0.2}
        ]
      },
      "mask": "upper"
    },
    {"node": {"clip": "lean", "root_motion": false}, "mode": "additive", "weight": "lean", "mask": "upper"},
    {"node": {"clip": "run", "root_motion": false}, "mode": "additive_in_model", "weight": "lean", "mask": "upper",
     "reference": "idle", "reference_time": 0.5}
  ]}
})";

}  // namespace sinew::fixtures
