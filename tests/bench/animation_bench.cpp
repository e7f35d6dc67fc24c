// What the animation jobs cost: nanoseconds per pose and per joint; for sampling, sequential playback against
// random seek.
#include <benchmark/benchmark.h>

#include <vector>

#include "bench/rigs.h"
#include "fixtures/clips.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/animation/skinning_job.h"

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
    benchmark::DoNotOptimize(SamplingJob<T>{&clip, time, jets}.Run());
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
    benchmark::DoNotOptimize(SamplingJob<float>{&clip, time, {}, poses}.Run());
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
    benchmark::DoNotOptimize(SamplingJob<T>{&clip, times[n++ % times.size()], jets}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

/// Layers: a whole-body mix of two, or a base with a masked override, or a base with an additive layer.
void blend(benchmark::State& state, BlendMode mode, bool masked) {
  const Clip clip = fixtures::random_clip({});
  std::vector<JointJet<float>> a(kJoints), b(kJoints), out(kJoints);
  (void)SamplingJob<float>{&clip, 1, a}.Run();
  (void)SamplingJob<float>{&clip, 3, b}.Run();
  std::vector<float> mask(kJoints, 0.5f);
  const std::span<const float> weights = masked ? std::span<const float>(mask) : std::span<const float>();
  const BlendLayer<float> layers[] = {{a, {0.7f, 0, 0}}, {b, {0.3f, 0.1f, 2}, weights, mode}};
  for (auto _ : state) {
    benchmark::DoNotOptimize(BlendingJob<float>{layers, {}, out}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

/// What is left of a transition, on top of a sampled pose: all joints turn, the first `moving` also shift.
void inertialize(benchmark::State& state) {
  const Clip clip = fixtures::random_clip({});
  const int moving = static_cast<int>(state.range(0));
  std::vector<JointJet<float>> a(kJoints), b(kJoints), out(kJoints);
  (void)SamplingJob<float>{&clip, 1, a}.Run();
  (void)SamplingJob<float>{&clip, 3, b}.Run();
  std::vector<float> numbers(inertial_numbers(kJoints, moving));
  InertialState<float> transition{numbers, kJoints, moving};
  (void)begin_inertial<float>(a, b, 1, transition);
  transition.elapsed = 0.3f;
  for (auto _ : state) {
    benchmark::DoNotOptimize(InertializeJob<float>{b, &transition, {}, out}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

void model_pose(benchmark::State& state) {
  const Clip clip = fixtures::random_clip({});
  std::vector<Transform<float>> poses(kJoints), model(kJoints);
  std::vector<int> parents(kJoints);
  for (int i = 0; i < kJoints; ++i) parents[i] = i % 5 == 0 ? i - 5 : i - 1;
  parents[0] = -1;
  (void)SamplingJob<float>{&clip, 1, {}, poses}.Run();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ModelPoseJob<float>{parents, {}, poses, {}, model}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

/// A limb at the end of a chain of eight joints.
void two_bone(benchmark::State& state) {
  const Clip clip = fixtures::random_clip({});
  std::vector<JointJet<float>> sampled(kJoints), jets(kJoints);
  const std::vector<int> parents = {-1, 0, 1, 2, 3, 4, 5, 6};
  (void)SamplingJob<float>{&clip, 1, sampled}.Run();
  const MovingTransform<float> end = model_motion<float>(sampled, parents, 7);
  for (auto _ : state) {
    jets = sampled;
    TwoBoneJob<float> job{parents, std::span(jets).first(8), 5, 6, 7};
    job.target = end.translation * 0.95f;
    benchmark::DoNotOptimize(job.Run());
    benchmark::ClobberMemory();
  }
}

/// Two locked feet and a pelvis.
void feet(benchmark::State& state) {
  FootState<float> feet[2];
  for (auto _ : state) benchmark::DoNotOptimize(bench::place_feet(feet));
}

/// Spine, chest, neck and head.
void look_at(benchmark::State& state) {
  LookState<float> head;
  for (auto _ : state) benchmark::DoNotOptimize(bench::look(head));
}

void mirror(benchmark::State& state) {
  const Clip clip = fixtures::random_clip({});
  const MirrorMap<float> map = bench::mirror_map(kJoints);
  std::vector<JointJet<float>> a(kJoints), out(kJoints);
  (void)SamplingJob<float>{&clip, 1, a}.Run();
  for (auto _ : state) {
    benchmark::DoNotOptimize(MirrorJob<float>{&map, a, out}.Run());
    benchmark::ClobberMemory();
  }
  per_joint(state);
}

void skinning(benchmark::State& state) {
  constexpr int kVertices = 10000;
  const std::vector<SkinMatrix> palette(
      kJoints, {{Eigen::Vector4f::UnitX(), Eigen::Vector4f::UnitY(), Eigen::Vector4f::UnitZ()},
                Eigen::Vector4f::Zero()});
  std::vector<std::uint16_t> joints(4 * kVertices);
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = std::uint16_t(i * 7 / 100 % kJoints);
  const std::vector<float> weights(4 * kVertices, 0.25f), positions(3 * kVertices, 0.6f);
  std::vector<float> out(3 * kVertices), normals(3 * kVertices);
  for (auto _ : state) {
    const SkinningJob job{palette, 4, joints, weights, positions, positions, out, normals};
    benchmark::DoNotOptimize(job.Run());
    benchmark::ClobberMemory();
  }
  state.counters["per vertex"] = benchmark::Counter(
      kVertices, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(model_pose);
BENCHMARK(inertialize)->ArgName("moving")->Arg(1)->Arg(kJoints);
BENCHMARK(two_bone);
BENCHMARK(feet);
BENCHMARK(look_at);
BENCHMARK(mirror);
BENCHMARK(skinning);
BENCHMARK_CAPTURE(blend, mix, BlendMode::kMix, false);
BENCHMARK_CAPTURE(blend, mix_masked, BlendMode::kMix, true);
BENCHMARK_CAPTURE(blend, override_masked, BlendMode::kOverride, true);
BENCHMARK_CAPTURE(blend, additive, BlendMode::kAdditive, false);
BENCHMARK(sequential<float>)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(poses_only)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(random_seek<float>)->ArgName("degree")->Arg(3)->Arg(5);
BENCHMARK(sequential<double>)->ArgName("degree")->Arg(5);

}  // namespace
}  // namespace sinew
