// Graphs as text and as files: what they say comes back, and what is wrong with them is said in one line.
#include <array>
#include <functional>
#include <random>

#include "graph/attribution.h"
#include "graph/describe.h"
#include "graph_fixture.h"
#include "sinew/graph/graph_file.h"

namespace sinew {
namespace {

using graph_tools::compile_graph;
using graph_tools::Compiled;

struct Wrong {
  const char* json;
  const char* message;  ///< where and what
};

TEST(GraphCompile, FaultsNameFileLineAndCulprit) {
  const Wrong cases[] = {
      {"", "test:1: is no JSON"},
      {"{\n\"graph\": \"walk\",\n}", "test:3: is no JSON"},
      {"{\"graph\": \"walk\",\n \"graph\": \"run\"}", "test:2: 'graph' stands twice"},
      {"[]", "test:1: expected an object"},
      {"{}", "'graph' is missing"},
      {"{\n\"grahp\": 1}", "test:2: unknown key 'grahp', known are: parameters, nodes, graph"},
      {R"({"graph": null})", "the graph has no pose"},
      {R"({"graph": {"clop": "walk"}})", "a node has one of"},
      {R"({"graph": {"clip": "walk", "speed": "fast"}})", "no parameter 'fast', known are: none"},
      {R"({"graph": {"clip": "walk", "speed": 1e9}})", "must be from -100.0 to 100.0"},
      {R"({"graph": {"clip": "walk", "sync": "feet", "speed": 0}})", "speed of a synchronised clip"},
      {"{\"parameters\": {\n\"go\": true,\n\"x\": {\"type\": \"floot\"}}, \"graph\": \"walk\"}",
       "test:3: unknown 'floot', known are: float, bool, trigger"},
      {R"({"parameters": {"go": true}, "graph": {"clip": "walk", "speed": "go"}})",
       "parameter 'go' is no float"},
      {R"({"parameters": {"time": 1}, "graph": "walk"})", "'time' means something in conditions already"},
      {R"({"parameters": {"a b": 1}, "graph": "walk"})", "name of a parameter"},
      {R"({"parameters": {"a": {"type": "bool", "filter": 1}}, "graph": "walk"})",
       "only floats are filtered"},
      {R"({"nodes": {"a": {"layers": ["b"]}, "b": {"layers": ["a"]}}, "graph": "a"})",
       "node 'a' contains itself: a > b > a"},
      {R"({"parameters": {"s": 0}, "graph": {"blend": "s", "points": [[0, "a"], [1]]}})",
       "a point is [position, node]"},
      {R"({"parameters": {"s": 0}, "graph": {"blend": "s", "points": [[0, null]]}})",
       "a blend has an empty child"},
      {R"({"graph": {"layers": ["a", {"node": "b", "mode": "overide"}]}})", "unknown 'overide', known are"},
      {R"({"graph": {"layers": ["a", {"node": "b", "weight": 2}]}})", "must be from 0.0 to 1.0"},
      {R"({"graph": {"layers": ["a", {"node": "b", "reference": "c"}]}})",
       "only additive layers have a reference"},
      {"{\"graph\": {\"layers\": [\"a\",\n{\"node\":\n{\"feet\": \"b\"}}]}}",
       "test:2: feet are of the whole pose"},
      {R"({"graph": {"feet": {"feet": "a"}}})", "feet stand twice"},
      {R"({"graph": {"feet": "a", "lock_at": 0.3}})", "contact weights of locking and releasing"},
      {R"({"graph": {"feet": null}})", "there is nothing here"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "a", "at": ["x", "x"]}})",
       "a look is at three parameters"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "a", "at": ["x", "x", "y"]}})", "no parameter 'y'"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "a", "at": ["x", "x", "x"], "yaw": 4}})",
       "yaw is not within"},
      {R"({"graph": {"travel": "a"}})", "a travel has one of: forward, left, turn"},
      {R"({"graph": {"states": {}}})", "expected states by name"},
      {R"({"graph": {"states": {"a": "x", "b": null}}})", "only a machine that is a layer has empty states"},
      {R"({"graph": {"states": {"a": {"conduit": true}}}})", "cannot start in a conduit"},
      {R"({"graph": {"states": {"a": "x"}, "start": "b"}})", "no state 'b', known are: a"},
      {R"({"graph": {"states": {"a": "x", "b": "y"}, "transitions": [{"to": "b"}]}})", "'from' is missing"},
      {R"({"graph": {"states": {"a": "x", "b": "y"}, "transitions": [{"from": "a", "to": "b", "if": "false"}]}})",
       "can never fire: its condition is false"},
      {R"({"graph": {"states": {"a": "x", "b": "y"}, "transitions": [{"from": "a", "to": "b", "kind": "dead", "profile": "m"}]}})",
       "only inertial transitions without a budget have a profile"},
      {R"({"graph": {"states": {"a": "x", "b": "y"}, "transitions": [{"from": "a", "to": "b", "share": 0.5}]}})",
       "a share is of the joints of a profile"},
      {R"({"graph": {"states": {"a": "x", "b": "y"}, "transitions": [{"from": "a", "to": "b", "profile": "m", "share": 0}]}})",
       "must be from 0.1 to 1.0"},
      {"{\"parameters\": {\"s\": 0},\n\"graph\": {\"states\": {\"a\": \"x\", \"b\": \"y\"}, \"transitions\": "
       "[\n"
       "{\"from\": \"a\", \"to\": \"b\", \"if\": \"s > 2 && s < 1\"}]}}",
       "test:3: transition to 'b' can never fire: no values make \"s > 2 && s < 1\" true"},
      {"{\"parameters\": {\"x\": 0,\n\"physics.lod\": 0}, \"graph\": \"walk\"}",
       "test:2: no physical value is called 'physics.lod', known are: physics.tilt"},
      {R"({"parameters": {"physics.load": true}, "graph": "walk"})", "'physics.load' is a number"},
      {"{\"graph\": {\"states\": {\"a\": \"x\", \"b\": \"y\", \"c\": \"z\"}, \"transitions\": [\n"
       "{\"from\": \"a\", \"to\": \"b\"},\n{\"from\": \"a\", \"to\": \"c\", \"if\": \"time > 1\"}]}}",
       "test:3: transition can never fire: one before it, to 'b', has no condition"}};
  for (const Wrong& c : cases) {
    const Compiled compiled = compile_graph(c.json, "test");
    EXPECT_NE(compiled.error.find(c.message), std::string::npos) << c.json << "\n  said: " << compiled.error;
    EXPECT_EQ(compiled.error.find('\n'), std::string::npos) << "one line";
  }
}

std::string with_condition(const std::string& condition) {
  return R"({"parameters": {"speed": 1, "free": true, "jump": "trigger"}, "graph": {"states": {
    "a": {"clip": "walk", "sync": "feet"}, "b": "run"}, "transitions": [{"from": "a", "to": "b", "if": ")" +
         condition + "\"}]}}";
}

TEST(GraphCompile, ConditionsSayWhatTheyMean) {
  const Wrong wrong[] = {{"speed", "'speed' is a number: compare it"},
                         {"free > 1", "'free' is true or false and cannot be compared"},
                         {"sped > 1", "no parameter 'sped'"},
                         {"speed > ", "ends too early"},
                         {"speed > 1 free", "does not understand 'free'"},
                         {"(free", "')' is missing"},
                         {"phase(hands) > 0.5", "no clip is synchronised as 'hands'"},
                         {"free & jump", "does not understand '& jump'"},
                         {"speed < 1e99", "no number"}};
  for (const Wrong& c : wrong) {
    const std::string error = compile_graph(with_condition(c.json), "test").error;
    EXPECT_NE(error.find(c.message), std::string::npos) << c.json << "\n  said: " << error;
  }
  std::string deep = "free";
  for (int k = 0; k < 100; ++k) deep = "(" + deep + ")";
  EXPECT_NE(compile_graph(with_condition(deep), "test").error.find("nested too deep"), std::string::npos);

  // As it is evaluated, for all values of what it asks.
  struct Right {
    const char* text;
    bool (*meant)(float speed, bool free, bool jump);
  };
  const Right right[] = {
      {"speed > 1 && free || jump", [](float s, bool f, bool j) { return (s > 1 && f) || j; }},
      {"speed > 1 && (free || jump)", [](float s, bool f, bool j) { return s > 1 && (f || j); }},
      {"!free && !(speed <= 1)", [](float s, bool f, bool) { return !f && !(s <= 1); }},
      {"speed != 1 || !jump", [](float s, bool, bool j) { return s != 1 || !j; }},
      {"speed >= 1", [](float s, bool, bool) { return s >= 1; }},
      {"-0.5 < speed && speed == 2", [](float s, bool, bool) { return s == 2; }},
      {"true && free", [](float, bool f, bool) { return f; }}};
  const Asset asset = fixtures::graph_asset();
  for (const Right& c : right) {
    Graph graph;
    fixtures::bind_graph(with_condition(c.text), asset, graph);
    for (int k = 0; k < 12; ++k) {
      fixtures::GraphPlayer<float> player(graph);
      const int third = k / 4;
      const auto speed = static_cast<float>(third);
      const bool free = (k & 1) != 0, jump = (k & 2) != 0;
      player.set("speed", double(speed));
      player.set("free", free);
      if (jump) player.trigger("jump");
      player.update(0.01);
      EXPECT_EQ(player.in("graph") == "b", c.meant(speed, free, jump))
          << c.text << " of " << speed << free << jump;
    }
  }
}

TEST(GraphCompile, ConditionsThatNothingMakesTrueAreFaults) {
  const char* never[] = {"speed > 2 && speed < 1",
                         "speed > 1 && speed <= 1",
                         "speed == 1 && speed != 1",
                         "speed >= 1 && 1 >= speed && speed != 1",
                         "speed < speed",
                         "free && !free",
                         "!(free || !free)",
                         "jump && speed > 3 && (speed < 2 || speed == 0)",
                         "time < 0",
                         "remaining < -1",
                         "phase(feet) > 1",
                         "speed > 2000000",
                         "!(speed < 1 || speed > 0)",
                         "2 < 1",
                         "event(hit) && !event(hit)",
                         "!(time >= 0)"};
  for (const char* condition : never) {
    const std::string error = compile_graph(with_condition(condition), "test").error;
    EXPECT_NE(error.find("transition to 'b' can never fire: no values make"), std::string::npos)
        << condition << "\n  said: " << error;
  }
  const char* possible[] = {"speed > 1 && speed < 2",
                            "speed >= 1 && speed <= 1",
                            "speed > 2 || speed < 1",
                            "speed < -999999",
                            "free && !jump",
                            "time > 100 && remaining > 100",
                            "phase(feet) >= 0.99 && phase(feet) < 1",
                            "!(speed > 2 && speed < 1)",
                            "time <= 0",
                            "speed < 1 && (speed > 2 || free)"};
  for (const char* condition : possible)
    EXPECT_EQ(compile_graph(with_condition(condition), "test").error, "") << condition;
  const std::string physical = R"({"parameters": {"physics.tilt": 0, "physics.load": 0}, "graph": {"states": {
    "a": "walk", "b": "run"}, "transitions": [{"from": "a", "to": "b", "if": ")";
  EXPECT_NE(compile_graph(physical + "physics.tilt > 90\"}]}}", "test").error.find("can never fire"),
            std::string::npos)
      << "radians";
  EXPECT_NE(compile_graph(physical + "physics.load < 0\"}]}}", "test").error.find("can never fire"),
            std::string::npos);
  EXPECT_EQ(compile_graph(physical + "physics.tilt > 1.5 && physics.load > 0.9\"}]}}", "test").error, "");
}

/// Random conditions over few values: what is called impossible is false for all of them, and what has but
/// thresholds between those values and is false for all of them is called impossible.
TEST(GraphCompile, ImpossibleIsWhatIsFalseForAllValues) {
  std::mt19937 random(3);
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const std::function<std::string(int)> any = [&](int depth) -> std::string {
    if (depth == 0 || below(4) == 0) {
      if (below(3) == 0) return below(2) ? "free" : "!free";
      static constexpr const char* kOperators[] = {"<", "<=", ">", ">=", "==", "!="};
      return std::string("speed ") + kOperators[below(6)] + " " + std::to_string(below(4));
    }
    const std::string both = "(" + any(depth - 1) + (below(2) ? " && " : " || ") + any(depth - 1) + ")";
    return below(4) ? both : "!" + both;
  };
  const Asset asset = fixtures::graph_asset();
  int impossible = 0;
  for (int n = 0; n < 400; ++n) {
    const std::string condition = any(3);
    const Compiled compiled = compile_graph(with_condition(condition), "test");
    bool ever = false;
    {
      // Played under "or never", which lets every condition pass the check.
      Graph graph;
      fixtures::bind_graph(with_condition("(" + condition + ") || remaining > 1000 && jump"), asset, graph);
      for (int k = 0; k < 18 && !ever; ++k) {
        const int step = k / 2 - 1;
        fixtures::GraphPlayer<float> player(graph);
        player.set("speed", step * 0.5);  // the thresholds, between them, and beyond
        player.set("free", k % 2);
        player.update(0);
        ever = player.in("graph") == "b";
      }
    }
    EXPECT_EQ(compiled.error.empty(), ever) << condition << "\n  said: " << compiled.error;
    impossible += !ever;
  }
  EXPECT_GT(impossible, 10);
}

TEST(GraphCompile, WhatIsProbablyAMistakeIsAWarning) {
  const Compiled compiled = compile_graph(
      "{\"parameters\": {\"speed\": 0,\n\"unused\": 1},\n\"nodes\": {\"also_unused\": \"walk\"},\n"
      "\"graph\": {\"states\": {\"a\": {\"clip\": \"walk\", \"speed\": \"speed\"},\n\"island\": \"run\"}}}",
      "test");
  EXPECT_EQ(compiled.error, "");
  ASSERT_EQ(compiled.warnings.size(), 3u);
  EXPECT_EQ(compiled.warnings[0], "test:5: graph: no transition leads to state 'island'");
  EXPECT_EQ(compiled.warnings[1], "test:2: parameter 'unused' is not used");
  EXPECT_EQ(compiled.warnings[2], "test:3: node 'also_unused' is not used");
}

TEST(GraphCompile, AnAssetWithoutWhatItPlaysIsRefused) {
  const Asset asset = fixtures::graph_asset();
  const Wrong cases[] = {
      {R"({"graph": {"states": {"a": "idle", "b": "walk"}, "transitions": [{"from": "a", "to": "b", "profile": "tail"}]}})",
       "no mask of the name of a transition's profile ('tail')"},
      {"{\n\"graph\": \"wolk\"}", "test:2: graph: the asset has no clip of this name ('wolk')"},
      {R"({"graph": {"clip": "idle", "sync": "feet"}})",
       "a synchronised clip has no markers of its phase ('idle')"},
      {R"({"graph": {"clip": "hit", "sync": "feet"}})", "a clip that does not loop cannot be synchronised"},
      {R"({"graph": {"feet": "idle"}})", "thigh, shin, foot or toes have no role"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "idle", "at": ["x", "x", "x"]}})",
       "no joint has the role of a head"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "idle", "at": ["x", "x", "x"], "joints": [["joint3", 1], ["joint2", 1]]}})",
       "joints are not one below the other"},
      {R"({"parameters": {"x": 0}, "graph": {"look": "idle", "at": ["x", "x", "x"], "joints": [["joint3", 1], ["neck", 1]]}})",
       "the asset has no joint of the look's names ('neck')"},
      {R"({"graph": {"layers": ["idle", {"node": "run", "mask": "lower"}]}})",
       "no mask of this name ('lower')"},
      {R"({"graph": {"layers": ["idle", {"node": "run", "mode": "additive", "reference": "rest"}]}})",
       "no clip of the reference's name ('rest')"},
      {R"({"parameters": {"s": 0}, "graph": {"blend": "s", "points": [[0, "idle"], [0, "run"]]}})",
       "points are nearer than five nodes"}};
  for (const Wrong& c : cases) {
    const Compiled compiled = compile_graph(c.json, "test");
    ASSERT_EQ(compiled.error, "") << c.json;
    const std::string fault = graph_tools::bind_fault(compiled, "test", asset);
    EXPECT_NE(fault.find(c.message), std::string::npos) << c.json << "\n  said: " << fault;
  }
}

TEST(GraphCompile, FiveThousandDamagedTextsGiveOneLineOrAGraph) {
  const std::string text = fixtures::kSmoothGraph;
  const std::string pieces[] = {"{",    "}",  "[",   "]",        "\"",    ":",      ",", "null",
                                "true", "-1", "1e9", "\"move\"", "\"*\"", "\"if\"", "\n"};
  std::mt19937 random(6);
  int compiled = 0;
  for (int k = 0; k < 5'000; ++k) {
    std::string damaged = text;
    for (int n = 0; n <= k % 3; ++n) {
      const std::size_t at = std::uniform_int_distribution<std::size_t>(0, damaged.size() - 1)(random);
      const std::size_t length = random() % 12;
      damaged.replace(at, std::min(length, damaged.size() - at), pieces[random() % std::size(pieces)]);
    }
    const Compiled made = compile_graph(damaged, "test");
    EXPECT_EQ(made.error.find('\n'), std::string::npos) << made.error;
    compiled += made.error.empty();
    if (made.error.empty()) {
      EXPECT_TRUE(validate(made.graph).ok());
    }
  }
  EXPECT_GT(compiled, 25);
}

TEST(GraphFile, SaysWhatTheTextSaid) {
  const Compiled compiled = compile_graph(fixtures::kSmoothGraph, "test");
  ASSERT_EQ(compiled.error, "");
  const std::vector<std::uint8_t> bytes = write_graph(compiled.graph);
  GraphDefinition read;
  const Status status = read_graph(bytes, read);
  ASSERT_TRUE(status.ok()) << status.reason;
  EXPECT_EQ(write_graph(read), bytes);
  EXPECT_EQ(graph_tools::graph_dot(read), graph_tools::graph_dot(compiled.graph));
}

TEST(GraphFile, AHundredThousandDamagedFilesAreRefusedOrHarmless) {
  const Asset asset = fixtures::graph_asset();
  const std::vector<std::uint8_t> bytes = write_graph(compile_graph(fixtures::kSmoothGraph, "test").graph);
  std::mt19937 random(5);
  int read = 0, played = 0;
  for (int k = 0; k < 100'000; ++k) {
    std::vector<std::uint8_t> damaged = bytes;
    const int changes = 1 + k % 3;
    for (int n = 0; n < changes; ++n)
      damaged[std::uniform_int_distribution<std::size_t>(0, damaged.size() - 1)(random)] =
          static_cast<std::uint8_t>(random());
    if (k % 10 == 0) damaged.resize(std::uniform_int_distribution<std::size_t>(0, damaged.size())(random));
    GraphDefinition definition;
    if (!read_graph(damaged, definition)) continue;
    ++read;
    Graph graph;
    if (read % 20 != 0 || !Graph::bind(definition, asset, graph)) continue;
    ++played;
    fixtures::GraphPlayer<float> player(graph);
    for (int frame = 0; frame < 20; ++frame) {
      for (std::size_t p = 0; p < definition.parameters.size(); ++p) {
        GraphParameters<float> parameters(graph, player.state);
        (void)parameters.set(int(p), float(frame % 4));
        if (frame % 5 == 0) (void)parameters.trigger(int(p));
      }
      // A status, or a pose; never memory of somebody else (the sanitizers watch).
      if (!GraphUpdateJob<float>{&graph, player.state, 0.02f, &player.scratch, &player.events}.Run()) break;
      GraphPoseJob<float> job{&graph, player.state, &player.scratch, player.jets, player.curves};
      job.physical = player.physical;
      (void)job.Run();
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(played, 20);
  RecordProperty("read", read);
}

TEST(GraphDescribe, SaysWhatPlaysAndWhatItWaitsFor) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  fixtures::GraphPlayer<float> player(graph);
  player.step(0);
  player.trigger("hit");
  player.step(0.01);
  const graph_tools::Json described = graph_tools::describe_state(graph, player.state);
  const graph_tools::Json& machine = described["plays"]["children"][0];
  EXPECT_EQ(machine["state"], "hit");
  EXPECT_EQ(machine["transition"]["fade"], "offset");
  EXPECT_EQ(machine["plays"]["clip"], "hit");
  bool waits = false;
  for (const auto& w : machine["waits"])
    if (w["to"] == "move") waits = w["condition"] == "(remaining < 0.2 && !(fading))" && w["holds"] == false;
  EXPECT_TRUE(waits) << machine.dump(2);
}

TEST(GraphDescribe, NamesEveryWayToFade) {
  const Asset asset = fixtures::graph_asset();
  for (const auto& [way, fade] :
       std::initializer_list<std::array<const char*, 2>>{{"inertial", "offset"},
                                                         {"dead", "left pose"},
                                                         {"crossfade", "crossfade"},
                                                         {"smoothstep", "smoothstep"},
                                                         {"cut", "none"}}) {
    Graph graph;
    fixtures::bind_graph(
        std::string(R"({"parameters": {"go": "trigger"}, "graph": {"states": {"a": "idle", "b": "walk"},
      "transitions": [{"from": "a", "to": "b", "if": "go", "kind": ")") +
            way + R"(", "duration": 0.2}]}})",
        asset, graph);
    fixtures::GraphPlayer<float> player(graph);
    player.step(0);
    player.trigger("go");
    player.step(0.01);
    const graph_tools::Json machine = graph_tools::describe_state(graph, player.state)["plays"];
    EXPECT_EQ(machine["state"], "b") << way;
    if (machine.contains("transition"))
      EXPECT_EQ(machine["transition"]["fade"], fade) << way;
    else
      EXPECT_STREQ(fade, "none") << way;
  }
}

TEST(GraphAttribution, SharesAddUpToTheAcceleration) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  fixtures::GraphPlayer<float> player(graph);
  player.step(0);
  std::mt19937 random(2);
  const auto machine = [&](const char* name) {
    for (const Graph::BoundMachine& m : graph.machines())
      if (graph.node(m.node).name == name) return m.node;
    return -1;
  };
  bool transition_told = false;
  for (int k = 0; k < 400; ++k) {
    if (k % 40 == 10) player.set("speed", k % 80 ? 3 : 0);
    if (k % 90 == 30) player.trigger("hit");
    if (k % 130 == 50) player.trigger("dead");
    if (k == 100 || k == 200) player.set("wave", k == 100);
    if (k == 150) player.set("lean", 1);
    const int joint = k % fixtures::kGraphJoints;
    graph_tools::Attribution attribution(graph, player.scratch, joint);
    GraphStepJob<float> job{&graph,      player.state,   1 / 60.f, &player.scratch,
                            player.jets, &player.events, {},       player.physical};
    job.watch = attribution.watch();
    player.events.count = 0;
    ASSERT_TRUE(job.Run().ok());
    Vec3<float> sum = Vec3<float>::Zero();
    for (const graph_tools::AccelerationShare& share : attribution.shares()) {
      sum += share.alpha;
      transition_told |= share.node == machine("graph/0") && share.alpha.norm() > 1;
    }
    if (joint == 0) continue;  // the root is moved over the ground after all nodes
    EXPECT_LT((sum - player.jets[std::size_t(joint)].alpha).norm(), 1e-3 * (1 + sum.norm())) << "frame " << k;
  }
  EXPECT_TRUE(transition_told);
}

}  // namespace
}  // namespace sinew
