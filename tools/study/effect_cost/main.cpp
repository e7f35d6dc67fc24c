// Runs one effect with so many instances, for `sinew study effects` to count instructions and time of.
//
//     sinew-effect-cost MODE EFFECT INSTANCES STEPS
//
// What is counted happens in count_here(). Modes:
//
//     checked  World::step of a figure (figure.h) on its animation: residual, comparison, playback
//     bare     only kinematics and residual of that figure
//     pass     energy, gradient and matrix of one Newton pass over all 64 unknowns
//     solve    a solve of one pass, for contacts
//     step     World::step of so many things that are solved for
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "study/effect_cost/work.h"

namespace sinew::study {

void unknown(const std::string& effect) {
  std::fprintf(stderr, "no effect '%s' in this mode\n", effect.c_str());
  std::exit(3);
}

}  // namespace sinew::study

/// Named for callgrind's --toggle-collect.
extern "C" [[gnu::noinline]] void count_here(sinew::study::Work& work) {
  work.step();
}

int main(int argc, char** argv) {
  using namespace sinew::study;
  if (argc != 5) {
    std::fputs("usage: sinew-effect-cost checked|bare|pass|solve|step EFFECT INSTANCES STEPS\n", stderr);
    return 2;
  }
  const int instances = std::atoi(argv[3]), steps = std::atoi(argv[4]);
  std::unique_ptr<Work> work = make_kernel(argv[1], argv[2], instances);
  if (!work) work = make_world(argv[1], argv[2], instances);
  if (!work) return 2;
  for (int n = 0; n < 4; ++n) {  // caches, and what a first step does differently
    work->prepare();
    work->step();
  }
  std::chrono::duration<double, std::micro> time{};
  for (int n = 0; n < steps; ++n) {
    work->prepare();
    const auto begin = std::chrono::steady_clock::now();
    count_here(*work);
    time += std::chrono::steady_clock::now() - begin;
  }
  std::printf("%.6f %zu\n", time.count() / steps, work->bytes());
}
