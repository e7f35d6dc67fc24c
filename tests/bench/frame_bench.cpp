// One undisturbed frame of a character in a world: sampling left out, residual pass and comparison with the
// muscles.
#include <benchmark/benchmark.h>

#include "character/scenes.h"

namespace sinew {
namespace {

void undisturbed_frame(benchmark::State& state) {
  fixtures::Playing<float> scene;
  std::vector<std::vector<JointJet<float>>> frames;
  frames.reserve(600);
  for (int n = 0; n < 600; ++n) frames.push_back(fixtures::idle<float>(scene.skeleton, n / 60.0));
  std::size_t n = 0;
  for (auto _ : state) {
    (void)scene.character().set_target(frames[n++ % frames.size()]);
    benchmark::DoNotOptimize(scene.world.step(1 / 60.f));
  }
  if (!scene.character().on_animation()) state.SkipWithError("the character left its animation");
  state.counters["dofs"] = scene.character().report().dofs;
}

BENCHMARK(undisturbed_frame);

}  // namespace
}  // namespace sinew
