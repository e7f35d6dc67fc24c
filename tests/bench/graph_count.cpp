// Steps a graph so many times, for callgrind to count: the difference between two runs is the steps' own.
// 67 joints, float.
//
//     graph_count update|step|change|hero|finish|check CALLS
//
// `update`: 60 nodes, a machine of ten states, a blend by two parameters, scalars alone. `step`: four clips,
// three blends and layers, a transition that runs; pose included. `change`: as `step`, with a change of state
// in every frame. `hero`: all that a frame of a character on its animation takes, the same step with two feet
// on the ground and a look, then the world's: check of torques and model pose. `finish`: its graph alone,
// `check`: its world alone. Prints the median of the calls' times as well.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fixtures/clips.h"
#include "fixtures/humanoid.h"
#include "graph/compile.h"
#include "sinew/character/world.h"
#include "sinew/graph/graph_step.h"

namespace {

using namespace sinew;

Asset asset_of(int clips) {
  Asset asset;
  for (int j = 0; j < 67; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.parent = j - 1;
    joint.rest.translation = Vec3<float>(0.01f * float(j), 0.02f, 0.3f).cast<double>();  // as the clips'
    asset.skeleton.joints.push_back(joint);
  }
  for (int k = 0; k < clips; ++k) {
    asset.clips.push_back(fixtures::random_clip({.seed = unsigned(k + 1)}));
    asset.clips.back().name = "c" + std::to_string(k);
    asset.clips.back().markers = {{0, 1}, {0.5, 8}};
    asset.clips.back().events = {ClipEvent{1, 1, 1, false, {}}, ClipEvent{8, 8, 1, false, {}}};
  }
  return asset;
}

std::string sixty_nodes() {
  std::string states, transitions;
  int clip = 0;
  const auto next = [&] { return "\"c" + std::to_string(clip++) + "\""; };
  for (int s = 0; s < 9; ++s) {
    const std::string name = "s" + std::to_string(s);
    states += ", \"" + name + "\": {\"blend\": \"speed\", \"sync\": \"feet\", \"points\": [[0, " + next() +
              "], [1, " + next() + "], [2, " + next() + "], [3, " + next() + "]]}";
    transitions += std::string(s ? ", " : "") + R"({"from": "*", "to": ")" + name + R"(", "if": "pick == )" +
                   std::to_string(s) + " && speed > 0.5\"}";
  }
  std::string plane;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      plane +=
          (plane.empty() ? "[" : ", [") + std::to_string(x) + ", " + std::to_string(y) + ", " + next() + "]";
  return R"({"parameters": {"speed": 0.6, "side": 0.7, "pick": -1}, "graph": {"layers": [{"states": {"plane":
    {"blend": ["speed", "side"], "sync": "feet", "points": [)" +
         plane + "]}" + states + "}, \"transitions\": [" + transitions + "]}, {\"node\": " + next() +
         ", \"weight\": 0.3}]}}";
}

/// A blend, two layers and a transition: four clips play.
const std::string kLayers = R"({"layers": [
  {"states": {"a": {"blend": "speed", "sync": "feet", "points": [[0, "c0"], [1, "c1"]]},
              "b": {"blend": "speed", "sync": "feet", "points": [[0, "c2"], [1, "c3"]]}},
   "transitions": [{"from": "a", "to": "b", "if": "go", "duration": 1000}, {"from": "b", "to": "a", "if": "go", "duration": 1000}]},
  {"node": "c4", "weight": 0.5}, {"node": "c5", "mode": "additive", "weight": 0.5}]})";
const std::string kStep = R"({"parameters": {"speed": 0.5, "go": "trigger"}, "graph": )" + kLayers + "}";
const std::string kHero =
    R"({"parameters": {"speed": 0.5, "go": "trigger", "x": 5, "y": 2, "z": 1.5}, "graph": {"feet": {"look": )" +
    kLayers +
    R"(, "at": ["x", "y", "z"], "joints": [["neck", 1], ["neck2", 2], ["head", 3], ["eyes", 4]]}}})";

/// Fourteen bodies, and joints that ride along: neck and head, toes and fingers.
Asset hero_asset() {
  Asset asset;
  Skeleton& s = asset.skeleton = fixtures::humanoid();
  const auto named = [&](const std::string& name) {
    for (int j = 0; j < int(s.joints.size()); ++j)
      if (s.joints[std::size_t(j)].name == name) return j;
    return -1;
  };
  const auto add = [&](const std::string& name, const std::string& parent, const Vec3<double>& at) {
    Joint joint;
    joint.name = name;
    joint.parent = named(parent);
    joint.rest.translation = at;
    s.joints.push_back(joint);
  };
  add("neck", "chest", {0, 0, 0.05});
  add("neck2", "neck", {0, 0, 0.05});
  add("head", "neck2", {0, 0, 0.05});
  add("eyes", "head", {0, 0, 0.1});
  for (int right = 0; right < 2; ++right) {
    const std::string tail = right ? "_r" : "_l";
    add("toes" + tail, "foot" + tail, {0.12, 0, -0.06});
    const char* const parts[] = {"thigh", "shin", "foot", "toes"};
    for (int k = 0; k < 4; ++k)
      s.joints[std::size_t(named(parts[k] + tail))].role = Role(int(Role::kThighL) + 2 * k + right);
  }
  while (s.joints.size() < 67) add("finger" + std::to_string(s.joints.size()), "hand_l", {0, 0, -0.1});
  for (unsigned k = 0; k < 6; ++k) {
    Clip& clip = asset.clips.emplace_back(fixtures::swaying_clip(s, k + 1, 0.1));
    clip.name = "c" + std::to_string(k);
    clip.markers = {{0, 0.5}, {0.5, 2.5}};
    clip.contacts = {{named("foot_l"), 0, 2.2f}, {named("foot_r"), 2, 4.2f}};
  }
  return asset;
}

/// The world of a character that is strong enough for any animation.
struct HeroWorld {
  World<float> world{WorldSettings()};
  Status status;
  explicit HeroWorld(const Skeleton& skeleton) {
    (void)world.add_character(skeleton, {}, status);
    (void)world.character(0).set_strength(1e6f);
  }
  bool step(std::span<const JointJet<float>> jets, float h) {
    return world.character(0).set_target(jets).ok() && world.step(h).ok();
  }
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string job = argc == 3 ? argv[1] : "";
  const int calls = argc == 3 ? std::atoi(argv[2]) : 0;
  const bool update = job == "update", change = job == "change", check = job == "check",
             world = job == "hero" || check, hero = world || job == "finish";
  if (calls <= 0 || !(update || change || hero || job == "step")) {
    std::fputs("usage: graph_count update|step|change|hero|finish|check CALLS\n", stderr);
    return 2;
  }
  const Asset asset = hero ? hero_asset() : asset_of(50);
  const graph_tools::Compiled compiled = graph_tools::compile_graph(update ? sixty_nodes()
                                                                    : hero ? kHero
                                                                           : kStep,
                                                                    "graph");
  Graph graph;
  const Status bound = compiled.error.empty() ? Graph::bind(compiled.graph, asset, graph) : Status();
  if (!compiled.error.empty() || !bound) {
    std::fprintf(stderr, "graph_count: %s%s\n", compiled.error.c_str(), bound.reason);
    return 1;
  }
  GraphScratch<float> scratch(graph);
  std::vector<std::byte> state(graph.state_bytes<float>());
  (void)start_graph<float>(graph, state);
  GraphParameters<float> parameters(graph, state);
  std::vector<JointJet<float>> jets(67);
  HeroWorld body(hero ? asset.skeleton : fixtures::humanoid());
  constexpr float h = 1 / 60.f;
  const int go = compiled.graph.find_parameter("go");
  if (!update) {
    (void)GraphStepJob<float>{&graph, state, h, &scratch, jets}.Run();
    (void)parameters.trigger(go);
  }
  bool ok = true;
  std::vector<double> times;
  times.reserve(std::size_t(calls));
  double last = seconds();
  for (int k = 0; k < calls; ++k) {
    if (change) ok &= parameters.trigger(go).ok();
    if (update)
      ok &= GraphUpdateJob<float>{&graph, state, h, &scratch}.Run().ok();
    else if (!check || k == 0)
      ok &= GraphStepJob<float>{&graph, state, h, &scratch, jets}.Run().ok();
    if (world) ok &= body.step(jets, h);
    const double now = seconds();
    times.push_back(now - last);
    last = now;
  }
  std::nth_element(times.begin(), times.begin() + calls / 2, times.end());
  std::printf("%zu nodes, %zu bytes of state, %.0f ns\n", compiled.graph.nodes.size(), state.size(),
              1e9 * times[std::size_t(calls / 2)]);
  if (world && !body.world.character(0).on_animation()) {
    std::fputs("graph_count: the character left its animation\n", stderr);
    return 1;
  }
  return ok ? 0 : 1;
}
