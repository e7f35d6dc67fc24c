// A character that follows a graph: it stands, walks and runs as fast as the stick asks, is pushed while it
// changes from one to the other, and is taken back to a snapshot of both, graph and world.
// Usage: graph ASSET.sinew GRAPH.sgraph [SECONDS]
#include <sinew/character/physics_values.h>
#include <sinew/graph/graph_file.h>
#include <sinew/graph/graph_step.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace {

bool read_file(const char* path, std::vector<std::uint8_t>& bytes) {
  std::ifstream file(path, std::ios::binary);
  bytes.assign(std::istreambuf_iterator<char>(file), {});
  return !bytes.empty();
}

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "graph: %s: %s\n", what, why);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: graph ASSET.sinew GRAPH.sgraph [SECONDS]\n");
    return 2;
  }
  // Set-up: one graph for all characters of an asset, one scratch a thread.
  sinew::Asset asset;
  sinew::GraphDefinition definition;
  sinew::Graph graph;
  std::vector<std::uint8_t> bytes;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  if (!read_file(argv[2], bytes)) return fail(argv[2], "cannot be read");
  if (sinew::Status s = sinew::read_graph(bytes, definition); !s) return fail(argv[2], s.reason);
  if (sinew::Status s = sinew::Graph::bind(definition, asset, graph); !s) return fail(argv[2], s.reason);
  sinew::GraphScratch<float> scratch(graph);

  // One character: its block belongs to what the world saves.
  sinew::Status status;
  sinew::World<float> world({});
  const int hero = world.add_character(asset.skeleton, {}, status);
  if (!status) return fail(argv[1], status.reason);
  sinew::GraphMemory state(graph.state_bytes<float>());
  status = sinew::start_graph<float>(graph, state);
  if (!status) return fail(argv[2], status.reason);
  world.keep_with_state(state);
  sinew::GraphParameters<float> parameters(graph, state);
  const int speed = definition.find_parameter("speed");
  const int chest = asset.skeleton.find("chest");

  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size()), body(jets.size());
  std::vector<sinew::EventHit> hits(32);
  std::vector<std::byte> snapshot(world.snapshot_capacity());
  std::size_t saved = 0;
  constexpr float h = 1 / 60.f;
  const int frames = argc > 3 ? static_cast<int>(std::atof(argv[3]) * 60) : 300;
  for (int frame = 0; frame <= frames; ++frame) {
    // The stick moves in steps; what follows from it does not.
    if (frame == 30) (void)parameters.set(speed, 1.275f);
    if (frame == 120) (void)parameters.set(speed, 3.2f);
    if (frame == 130 && chest >= 0)
      status = world.character(hero).apply_impulse(chest, world.character(hero).model()[chest].translation,
                                                   {0, 60, 0});
    if (frame == 140) {
      snapshot.resize(world.snapshot_capacity());
      saved = world.save(snapshot);
    }
    if (frame == 200 && world.restore({snapshot.data(), saved})) std::puts("back to 2.33 s");

    sinew::physical_motion<float>(world.character(hero), body);  // for states that follow the physical pose
    sinew::EventSink events{hits};
    sinew::GraphStepJob<float> job{&graph, state, frame ? h : 0, &scratch, jets, &events};
    job.physical = body;
    if (status) status = job.Run();
    if (!status) return fail("step", status.reason);
    for (int e = 0; e < events.count; ++e)
      std::printf("%5.2f s  event %08x, %.3f s ago, weight %.2f\n", frame / 60.0, hits[e].event->name,
                  double(hits[e].seconds_ago), double(hits[e].weight));
    status = world.character(hero).set_target(jets);
    if (status) status = frame == 0 ? world.character(hero).reset() : world.step(h);
    if (!status) return fail("step", status.reason);
    if (frame % 15 == 0)
      std::printf("%5.2f s  at %.2f m, speed %.2f m/s, unknown DOFs %d\n", frame / 60.0,
                  parameters.place().x(), double(parameters.travel().velocity[0]),
                  world.character(hero).report().unknown_dofs);
  }
  return 0;
}
