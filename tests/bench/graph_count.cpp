// Steps a graph so many times, for callgrind to count: the difference between two runs is the steps' own.
// 67 joints, float.
//
//     graph_count update|step|change CALLS
//
// `update`: 60 nodes, a machine of ten states, a blend by two parameters, scalars alone. `step`: four clips,
// three blends and layers, a transition that runs; pose included. `change`: as `step`, with a change of state
// in every frame.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fixtures/clips.h"
#include "graph/compile.h"
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

constexpr const char* kHero = R"({"parameters": {"speed": 0.5, "go": "trigger"}, "graph": {"layers": [
  {"states": {"a": {"blend": "speed", "sync": "feet", "points": [[0, "c0"], [1, "c1"]]},
              "b": {"blend": "speed", "sync": "feet", "points": [[0, "c2"], [1, "c3"]]}},
   "transitions": [{"from": "a", "to": "b", "if": "go", "duration": 1000}, {"from": "b", "to": "a", "if": "go", "duration": 1000}]},
  {"node": "c4", "weight": 0.5}, {"node": "c5", "mode": "additive", "weight": 0.5}]}})";

}  // namespace

int main(int argc, char** argv) {
  const std::string job = argc == 3 ? argv[1] : "";
  const int calls = argc == 3 ? std::atoi(argv[2]) : 0;
  const bool update = job == "update", change = job == "change";
  if (calls <= 0 || !(update || change || job == "step")) {
    std::fputs("usage: graph_count update|step|change CALLS\n", stderr);
    return 2;
  }
  const Asset asset = asset_of(50);
  const graph_tools::Compiled compiled = graph_tools::compile_graph(update ? sixty_nodes() : kHero, "graph");
  Graph graph;
  if (!compiled.error.empty() || !Graph::bind(compiled.graph, asset, graph)) {
    std::fprintf(stderr, "graph_count: %s\n", compiled.error.c_str());
    return 1;
  }
  GraphScratch<float> scratch(graph);
  std::vector<std::byte> state(graph.state_bytes<float>());
  (void)start_graph<float>(graph, state);
  GraphParameters<float> parameters(graph, state);
  std::vector<JointJet<float>> jets(67);
  constexpr float h = 1 / 60.f;
  const int go = compiled.graph.find_parameter("go");
  if (!update) {
    (void)GraphStepJob<float>{&graph, state, h, &scratch, jets}.Run();
    (void)parameters.trigger(go);
  }
  bool ok = true;
  for (int k = 0; k < calls; ++k) {
    if (change) ok &= parameters.trigger(go).ok();
    if (update)
      ok &= GraphUpdateJob<float>{&graph, state, h, &scratch}.Run().ok();
    else
      ok &= GraphStepJob<float>{&graph, state, h, &scratch, jets}.Run().ok();
  }
  std::printf("%zu nodes, %zu bytes of state\n", compiled.graph.nodes.size(), state.size());
  return ok ? 0 : 1;
}
