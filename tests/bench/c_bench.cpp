// What a call through the C interface costs, and a frame of 100 characters on their clips through it and
// through C++.
//
//     c_bench ASSET calls|c|cpp [REPETITIONS]            // ns, the least of the repetitions
//     python3 python_bench.py ASSET [REPETITIONS]        // the same frame from Python, with build/python on
//     PYTHONPATH
//
// On a busy machine instructions say more: `valgrind --tool=callgrind` over two numbers of repetitions, the
// difference counts.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "sinew/animation/sampling_job.h"
#include "sinew/c/sinew.h"
#include "sinew/character/world.h"
#include "sinew/io/asset.h"

namespace {

constexpr int kCharacters = 100, kFrames = 20, kCalls = 100000;

/// Prints the least time of run(), which does something `count` times.
template <class Run>
void measure(const char* what, int repetitions, int count, Run&& run) {
  double least = 1e300;
  for (int n = 0; n < repetitions; ++n) {
    const auto begin = std::chrono::steady_clock::now();
    run(n);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    least = std::min(least, took.count() / count);
  }
  std::printf("%-40s %12.1f ns\n", what, least);
}

double time_of(int character, int frame) {
  return 0.01 * character + frame / 60.0;
}

void measure_cpp(const char* path, int repetitions) {
  sinew::Asset asset;
  if (!sinew::load_asset(path, asset)) std::exit(1);
  sinew::WorldSettings settings;
  settings.body_contact = false;  // all walk in the same place
  sinew::World<float> world(settings);
  sinew::Status status;
  for (int n = 0; n < kCharacters; ++n) (void)world.add_character(asset.skeleton, {}, status);
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  const auto frame = [&](int k) {
    for (int n = 0; n < kCharacters; ++n) {
      (void)sinew::SamplingJob<float>{&asset.clips[0], time_of(n, k), jets}.Run();
      (void)world.character(n).set_target(jets);
      if (k == 0) (void)world.character(n).reset();
    }
    (void)world.step(1 / 60.f);
  };
  frame(0);
  measure("C++, frame of 100 characters", repetitions, kFrames, [&](int n) {
    for (int k = 1; k <= kFrames; ++k) frame(n * kFrames + k);
  });
}

struct CWorld {
  sinew_asset asset = 0;
  sinew_world world = 0;
  std::vector<sinew_play> plays;

  explicit CWorld(const char* path) {
    sinew_world_settings settings{};
    settings.size = sizeof settings;
    (void)sinew_world_settings_init(&settings);
    settings.body_contact = 0;
    if (sinew_asset_load(path, &asset) != SINEW_OK || sinew_world_create(&settings, &world) != SINEW_OK)
      std::exit(1);
    for (int n = 0; n < kCharacters; ++n) {
      plays.push_back({0, asset, 0, 0, 0, 1, 0});
      (void)sinew_world_add_character(world, asset, nullptr, &plays.back().character);
    }
    frame(0);
  }
  void frame(int k) {
    for (int n = 0; n < kCharacters; ++n) plays[std::size_t(n)].time = time_of(n, k);
    (void)sinew_play_clips(plays.data(), kCharacters);
    for (int n = 0; n < kCharacters && k == 0; ++n)
      (void)sinew_character_reset(plays[std::size_t(n)].character);
    (void)sinew_world_step(world, 1 / 60.f);
  }
};

void measure_c(const char* path, int repetitions) {
  CWorld scene(path);
  measure("C, frame of 100 characters", repetitions, kFrames, [&](int n) {
    for (int k = 1; k <= kFrames; ++k) scene.frame(n * kFrames + k);
  });
}

void measure_calls(const char* path, int repetitions) {
  const CWorld scene(path);
  double where[3];
  measure("C, a call (displacement of a character)", repetitions, kCalls, [&](int) {
    for (int k = 0; k < kCalls; ++k)
      (void)sinew_character_get_displacement(scene.plays[std::size_t(k % kCharacters)].character, where);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: c_bench ASSET calls|c|cpp [REPETITIONS]\n");
    return 2;
  }
  const int repetitions = argc > 3 ? std::atoi(argv[3]) : 7;
  if (std::strcmp(argv[2], "cpp") == 0)
    measure_cpp(argv[1], repetitions);
  else if (std::strcmp(argv[2], "c") == 0)
    measure_c(argv[1], repetitions);
  else
    measure_calls(argv[1], repetitions);
  return 0;
}
