// What sampling costs: nanoseconds per pose and per joint, sequential playback against random seek.
#include <benchmark/benchmark.h>

#include <vector>

#include "fixtures/clips.h"
#include "sinew/animation/sampling_job.h"

namespace sinew {
namespace {

constexpr int kJoints = 67;  ///< of the rig that ozz-animation's own samples use

void per_joint(benchmark::State& state) {
  state.counters["per joint"] = benchmark::Counter(
      kJoints, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

fixtures::ClipShape shape_of(const benchmark::State& state) {
  fixtures::ClipShape shape;
  shape.degree = static_cast<int>(state.range(0));
  return shape;
}

template <class T>
void sequential(benchmark::State& state) {
  const Clip clip = fixtures::random_clip(shape_of(state));
  std::vector<JointJet<T>> jets(kJoints);
  double time = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(SamplingJob<T>{&clip, time, 1, jets}.Run());
    benchmark::ClobberMemory();
    time += 1 / 60.0;
  }
  per_joint(state);
}

void poses_only(benchmark::State& state) {
  const Clip clip = fixtures::random_clip(shape_of(state));
  std::vector<Transform<float>> poses(kJoints);
  double time = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(SamplingJob<float>{&clip, time, 1, {}, poses}.Run());
    benchmark::ClobberMemory();
    time += 1 / 60.0;
  }
  per_joint(state);
}

template <class T>
void random_seek(benchmark::State& state) {
  const Clip clip = fixtures::random_clip(shape_of(state));
  std::vector<JointJet<T>> jets(kJoints);
  std::mt19937 random(7);
  std::vector<double> times(4096);
  for (double& t : times) t = std::uniform_real_distribution<double>(0, clip.duration)(random);
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(SamplingJob<T>{&clip, times[n++ % times.size()], 1, jets}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

BENCHMARK(sequential<float>)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(poses_only)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(random_seek<float>)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(sequential<double>)->ArgName("degree")->Arg(5);

}  // namespace
}  // namespace sinew
