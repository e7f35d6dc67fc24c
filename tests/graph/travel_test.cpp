// Where a graph takes a character: the same place at any frame rate, through blends, and in step.
#include <cmath>

#include "fixtures/paths.h"
#include "graph_fixture.h"
#include "sinew/animation/foot_leg.h"
#include "sinew/graph/graph_contacts.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

constexpr const char* kMoving = R"({"parameters": {"speed": {"value": 1.5, "filter": 0.15}, "hit": "trigger"},
  "graph": {"states": {
    "move": {"blend": "speed", "sync": "feet", "points": [[0, {"clip": "idle", "sync": null}], [1.5, "walk"], [3.3, "run"]]},
    "hit": "hit"}, "transitions": [
    {"from": "move", "to": "hit", "if": "hit"}, {"from": "hit", "to": "move", "if": "remaining < 0.3"}]}})";

TEST(GraphTravel, IsTheSameAtEveryFrameRateToAMillimetre) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(
      R"({"parameters": {"speed": {"value": 1.5, "filter": 0.15}, "hit": "trigger"}, "graph": {"blend": "speed",
          "sync": "feet", "points": [[0, {"clip": "idle", "sync": null}], [1.5, "walk"], [3.3, "run"]]}})",
      asset, graph);
  const auto run = [&](auto step) {
    GraphPlayer<double> player(graph);
    player.step(0);
    double t = 0;
    for (int next = 1; next <= 60;) {
      const double h = std::min(step(), double(next) - t);
      player.step(h);
      t += h;
      if (t < double(next) - 1e-9) continue;
      t = next;
      player.set("speed", (next * 7 % 5) * 0.8);
      ++next;
    }
    return GraphParameters<double>(graph, player.state).place();
  };
  const Vec3<double> fine = run([] { return 1 / 1000.0; });
  EXPECT_GT(fine.norm(), 20);
  std::mt19937 random(4);
  EXPECT_LT((run([] { return 1 / 30.0; }) - fine).norm(), 1e-3);
  EXPECT_LT((run([] { return 1 / 60.0; }) - fine).norm(), 1e-3);
  EXPECT_LT((run([] { return 1 / 144.0; }) - fine).norm(), 1e-3);
  EXPECT_LT((run([&] { return std::uniform_real_distribution<double>(0.002, 0.05)(random); }) - fine).norm(),
            1e-3);
}

TEST(GraphTravel, ALoopGoesOnAsFarAsItsClip) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"graph": "walk"})", asset, graph);
  GraphPlayer<double> player(graph);
  player.step(0);
  for (int k = 0; k < 120'000; ++k) player.step(1 / 60.0);  // a thousand loops
  const Vec3<double> place = GraphParameters<double>(graph, player.state).place();
  EXPECT_LT((place - Vec3<double>(3000, 500, 0)).norm(), 1e-3);
  // What is shown is the clip itself, root and all.
  std::vector<JointJet<double>> clip(fixtures::kGraphJoints);
  ASSERT_TRUE((SamplingJob<double>{&asset.clips[1], 2000.0, clip}.Run().ok()));
  EXPECT_LT((clip[0].translation - player.jets[0].translation).norm(), 2e-3);
  EXPECT_LT((clip[0].velocity - player.jets[0].velocity).norm(), 1e-6);
  EXPECT_LT((clip[0].acceleration - player.jets[0].acceleration).norm(), 1e-5);
}

TEST(GraphTravel, AGameMayPutACharacterElsewhere) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"graph": "walk"})", asset, graph);
  GraphPlayer<double> player(graph), turned(graph);
  GraphParameters<double>(graph, turned.state).put({10, -5, 0}, 1.2);
  for (int k = 0; k < 100; ++k) {
    player.step(k ? 1 / 60.0 : 0);
    turned.step(k ? 1 / 60.0 : 0);
  }
  const Quat<double> by(Eigen::AngleAxisd(1.2, Vec3<double>::UnitZ()));
  EXPECT_LT((turned.jets[0].translation - (by * player.jets[0].translation + Vec3<double>(10, -5, 0))).norm(),
            1e-9);
  EXPECT_LT((turned.jets[0].velocity - by * player.jets[0].velocity).norm(), 1e-9);
  EXPECT_LT((turned.jets[0].acceleration - by * player.jets[0].acceleration).norm(), 1e-9);
}

TEST(GraphTravel, WalkAndRunPutTheirFeetDownTogether) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(kMoving, asset, graph);
  GraphPlayer<float> player(graph);
  player.step(0);
  int downs = 0;
  double last = 0;
  for (int k = 0; k < 60 * 30; ++k) {
    player.set("speed", k / 30 % 2 ? 1.8 : 3.0);  // from one to the other and back, every second
    player.step(1 / 60.0);
    // Of a blend the heavier clip's steps are reported: one for every half phase, never two.
    for (int e = 0; e < player.events.count; ++e) {
      const double when = k / 60.0 - double(player.hits[std::size_t(e)].seconds_ago);
      if (downs > 0) {
        EXPECT_GT(when - last, 0.5);
      }
      ++downs;
      last = when;
    }
  }
  EXPECT_GT(downs, 25);
}

// The demo character's walk is the same on both sides: mirrored, and half a cycle on, it is itself.
TEST(GraphMirror, AMirroredWalkInStepIsTheWalk) {
  Asset asset;
  ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
  Graph plain, mirrored;
  fixtures::bind_graph(R"({"graph": {"clip": "walk", "sync": "feet"}})", asset, plain);
  fixtures::bind_graph(R"({"graph": {"mirror": {"clip": "walk", "sync": "feet"}}})", asset, mirrored);
  GraphPlayer<double> a(plain), b(mirrored);
  for (int k = 0; k < 120; ++k) {
    a.step(k ? 1 / 60.0 : 0);
    b.step(k ? 1 / 60.0 : 0);
    for (std::size_t j = 0; j < a.jets.size(); ++j) {
      // The clip is symmetric as far as it was authored and fitted: a degree and some millimetres.
      EXPECT_LT(2 * (a.jets[j].rotation.conjugate() * b.jets[j].rotation).vec().norm(), 0.02)
          << j << " at " << k;
      EXPECT_LT((a.jets[j].translation - b.jets[j].translation).norm(), 0.01) << j << " at " << k;
    }
  }
}

TEST(GraphMirror, TurnsAndStepsToTheOtherSide) {
  Asset asset;
  ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
  asset.clips[std::size_t(asset.find_clip("walk"))].root_step.y() = 0.3f;
  Graph plain, mirrored;
  fixtures::bind_graph(R"({"graph": {"layers": ["walk"]}})", asset, plain);
  fixtures::bind_graph(R"({"graph": {"mirror": "walk"}})", asset, mirrored);
  GraphPlayer<double> a(plain), b(mirrored);
  for (int k = 0; k < 60; ++k) {
    a.step(k ? 1 / 60.0 : 0);
    b.step(k ? 1 / 60.0 : 0);
  }
  const Vec3<double> there = GraphParameters<double>(plain, a.state).place(),
                     other = GraphParameters<double>(mirrored, b.state).place();
  EXPECT_GT(there.y(), 0.2);
  EXPECT_LT((other - Vec3<double>(there.x(), -there.y(), 0)).norm(), 1e-9);
  // Fewer joints are mirrored from all: the other side is needed.
  GraphPlayer<double> all(mirrored), few(mirrored);
  few.jets.resize(5);
  for (int k = 0; k < 10; ++k) {
    all.step(k ? 1 / 60.0 : 0);
    few.step(k ? 1 / 60.0 : 0);
  }
  for (std::size_t j = 0; j < few.jets.size(); ++j)
    EXPECT_EQ(few.jets[j].rotation.coeffs(), all.jets[j].rotation.coeffs());
}

TEST(GraphMirror, EventsAreThoseOfTheOtherSide) {
  Asset asset = fixtures::graph_asset();
  asset.event_names = {"step_l", "step_r"};
  asset.clips[1].events[0].name = event_name("step_l");
  asset.clips[1].events[1].name = event_name("step_r");
  asset.clips[1].events.push_back(asset.clips[1].events[0]);  // a part that is left before its end
  asset.clips[1].events.back().end = 1.9f;
  constexpr const char* kJson = R"({"parameters": {"end": "trigger"},
    "graph": {"states": {"walk": {"mirror": "walk"}, "stop": "idle", "heard": "run"}, "transitions": [
      {"from": "walk", "to": "stop", "if": "end"}, {"from": "walk", "to": "heard", "if": "event(step_l) && time > 0.5"}]}})";
  Graph graph;
  fixtures::bind_graph(kJson, asset, graph);
  GraphPlayer<float> player(graph);
  std::vector<std::pair<std::uint32_t, EventKind>> heard;
  const auto listen = [&] {
    for (int k = 0; k < player.events.count; ++k)
      heard.emplace_back(player.hits[std::size_t(k)].event->name, player.hits[std::size_t(k)].kind);
  };
  for (int k = 0; k <= 20; ++k) player.step(k ? 0.01 : 0), listen();
  player.trigger("end");
  player.step(0.01);
  listen();
  const std::vector<std::pair<std::uint32_t, EventKind>> wanted = {
      {event_name("step_r"), EventKind::kInstant},
      {event_name("step_r"), EventKind::kBegin},
      {event_name("step_r"), EventKind::kEnd}};
  EXPECT_EQ(heard, wanted);
  GraphPlayer<float> other(graph);
  for (int k = 0; k <= 102; ++k) other.step(k ? 0.01 : 0);
  EXPECT_EQ(other.in("graph"), "heard") << "conditions hear the other side too";
}

TEST(GraphContacts, FeetRestAsTheClipsSay) {
  Asset asset;
  ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
  const Clip& walk = asset.clips[std::size_t(asset.find_clip("walk"))];
  const int foot = asset.skeleton.find(Role::kFootL), other = asset.skeleton.find(Role::kFootR);
  ASSERT_GE(foot, 0);
  Graph plain, mirrored;
  fixtures::bind_graph(R"({"graph": "walk"})", asset, plain);
  fixtures::bind_graph(R"({"graph": {"mirror": "walk"}})", asset, mirrored);
  GraphPlayer<float> a(plain), b(mirrored);
  int rests = 0, frames = 0;
  for (; frames < 120; ++frames) {
    a.step(frames ? 1 / 60.0 : 0);
    b.step(frames ? 1 / 60.0 : 0);
    const float contact = graph_contact(plain, a.scratch, foot);
    EXPECT_EQ(contact, in_contact(walk, frames / 60.0, foot) ? 1 : 0) << frames;
    EXPECT_EQ(graph_contact(mirrored, b.scratch, other), contact) << frames;
    rests += contact > 0;
  }
  EXPECT_GT(rests, 40);
  EXPECT_LT(rests, 100);
  EXPECT_EQ(graph_contact(plain, a.scratch, -1), 0);
}

TEST(GraphEvents, WhatBeganEndsWhenItsStateIsLeft) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"x({"parameters": {"go": false}, "graph": {"states": {"rise": "rise", "walk": "walk"},
    "transitions": [{"from": "rise", "to": "walk", "if": "go && event(helpless)", "kind": "inertial"},
                    {"from": "rise", "to": "walk", "if": "go && time > 0.6"}]}})x",
                       asset, graph);
  for (const bool crossfade : {false, true}) {
    Graph faded = graph;
    if (crossfade) {
      const auto compiled = graph_tools::compile_graph(
          R"({"parameters": {"go": false}, "graph": {"states": {"rise": "rise", "walk": "walk"},
             "transitions": [{"from": "rise", "to": "walk", "if": "go && time > 0.6", "kind": "crossfade"}]}})",
          "test");
      ASSERT_EQ(compiled.error, "");
      ASSERT_TRUE(Graph::bind(compiled.graph, asset, faded).ok());
    }
    GraphPlayer<float> player(faded);
    int begun = 0, ended = 0;
    for (int k = 0; k < 120; ++k) {
      if (k == 30) player.set("go", 1);
      player.step(k ? 1 / 60.0 : 0);
      for (int e = 0; e < player.events.count; ++e) {
        const EventHit& hit = player.hits[std::size_t(e)];
        if (hit.event->name != event_name("helpless")) continue;
        begun += hit.kind == EventKind::kBegin;
        ended += hit.kind == EventKind::kEnd;
      }
    }
    EXPECT_EQ(player.in("graph"), "walk");
    EXPECT_EQ(begun, 1) << crossfade;
    EXPECT_EQ(ended, 1) << crossfade;
  }
}

TEST(GraphPhysical, LeavesThePoseThatTheBodyHas) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(
      R"({"parameters": {"limp": true}, "graph": {"states": {"limp": {"physical": true}, "rise": "rise"},
    "transitions": [{"from": "limp", "to": "rise", "if": "!limp", "duration": 0.4}]}})",
      asset, graph);
  GraphPlayer<double> player(graph);
  std::vector<JointJet<double>> body(fixtures::kGraphJoints);
  const auto at = [&](double t) {
    ASSERT_TRUE((SamplingJob<double>{&asset.clips[1], t, body}.Run().ok()));
    player.physical = body;
  };
  at(0);
  player.step(0);
  for (int k = 1; k < 40; ++k) {
    at(k / 60.0);
    player.step(1 / 60.0);
  }
  at(40 / 60.0);
  player.set("limp", 0);
  player.step(0);
  EXPECT_EQ(player.in("graph"), "rise");
  // The first pose of the way up is the body's own, where it lies and as it moves.
  for (std::size_t j = 0; j < body.size(); ++j) {
    EXPECT_LT((body[j].rotation.conjugate() * player.jets[j].rotation).vec().norm(), 1e-6) << j;
    EXPECT_LT((body[j].translation - player.jets[j].translation).norm(), 1e-6) << j;
    EXPECT_LT((body[j].omega - player.jets[j].omega).norm(), 1e-6) << j;
    EXPECT_LT((body[j].velocity - player.jets[j].velocity).norm(), 1e-6) << j;
  }
}

}  // namespace
}  // namespace sinew
