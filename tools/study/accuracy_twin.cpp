// One run of a scene for callgrind to count: `sinew_accuracy_twin SCENE ENGINE OPTION STEP TOLERANCE
// SUBSTEPS`. The count of a step's instructions repeats to the last digit, where a clock does not
// (accuracy_instructions.cpp starts it).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "study/accuracy.h"

/// Counting begins and ends with this function.
extern "C" __attribute__((noinline)) bool sinew_twin_step(sinew::study::Engine* engine) {
  volatile bool alive = engine->step();  // not the last call: a jump would end the counting
  return alive;
}

int main(int argc, char** argv) {
  using namespace sinew::study;
  if (argc != 7) {
    std::fputs("usage: sinew_accuracy_twin SCENE ENGINE OPTION STEP TOLERANCE SUBSTEPS\n", stderr);
    return 2;
  }
  std::vector<EngineOption> options = sinew_options();
  for (const EngineOption& peer : peer_options()) options.push_back(peer);
  const double h = std::atof(argv[4]);
  sinew::Accuracy accuracy;
  accuracy.tolerance = std::atof(argv[5]);
  accuracy.substeps = static_cast<int>(std::strtol(argv[6], nullptr, 10));
  for (const AccuracyScene& s : accuracy_scenes())
    for (const EngineOption& option : options) {
      if (s.name != argv[1] || option.engine != argv[2] || option.option != argv[3]) continue;
      const auto engine = option.make(s.scene, h, accuracy);
      if (!engine->refusal().empty() || s.scene.figures.empty()) return 1;
      const int steps = static_cast<int>(std::lround(s.seconds / h));
      for (int n = 0; n < steps; ++n) {
        if (s.drive) s.drive(*engine, n * h, h);
        if (!sinew_twin_step(engine.get())) return 1;
      }
      return 0;
    }
  return 1;
}
