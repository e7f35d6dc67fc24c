// What a crowd of undisturbed characters costs on one core, per character, against plain playback of the
// same.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>
#include <random>

#include "crowd/job_system.h"
#include "fixtures/clips.h"
#include "fixtures/humanoid.h"
#include "fixtures/pile.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/crowd/instant.h"
#include "sinew/crowd/population.h"
#include "sinew/crowd/rig.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

void per_character(benchmark::State& state, int characters) {
  state.counters["per character"] = benchmark::Counter(
      characters, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Poses from the clip and their model transforms, one character after the other: what an engine does anyway.
void playback(benchmark::State& state) {
  const int characters = int(state.range(0));
  const Skeleton rig = fixtures::humanoid();
  const int joints = int(rig.joints.size());
  const Clip clip = fixtures::random_clip({.joints = joints});
  std::vector<int> parents;
  for (const Joint& joint : rig.joints) parents.push_back(joint.parent);
  std::vector<Transform<float>> poses(joints), models(std::size_t(joints) * characters);
  double time = 0;
  for (auto _ : state) {
    for (int i = 0; i < characters; ++i) {
      (void)SamplingJob<float>{&clip, time + 0.01 * i, {}, poses}.Run();
      const std::span out(models.data() + std::size_t(i) * joints, joints);
      (void)ModelPoseJob<float>{parents, {}, poses, {}, out}.Run();
    }
    benchmark::ClobberMemory();
    time += kStep;
  }
  per_character(state, characters);
}

std::unique_ptr<Crowd> crowd_of(const Skeleton& rig, const CrowdSettings& settings) {
  Status status;
  auto crowd = Crowd::create(rig, settings, status);
  for (int i = 0; i < settings.capacity; ++i) (void)crowd->set_strength(i, 1e6f);
  return crowd;
}

/// The whole frame: sampling, residual, support, comparison, model poses.
void crowd_frame(benchmark::State& state, InstructionSet set, int lanes) {
  if (!available(set)) return state.SkipWithError("this processor lacks the instruction set");
  const Skeleton rig = fixtures::humanoid();
  const Clip clip = fixtures::random_clip({.joints = int(rig.joints.size())});
  CrowdSettings settings;
  settings.capacity = int(state.range(0));
  settings.instruction_set = set;
  settings.lanes = lanes;
  const auto crowd = crowd_of(rig, settings);
  for (int i = 0; i < settings.capacity; ++i) (void)crowd->play(i, {&clip, 0.01 * i, {}});
  for (auto _ : state) benchmark::DoNotOptimize(crowd->step(kStep));
  if (!crowd->overloaded().empty()) state.SkipWithError("a character left its animation");
  per_character(state, settings.capacity);
}

/// Torques and comparison alone, from jets that stay as they are. 0: all; 1: with ground support; 2: and
/// poses.
void crowd_check(benchmark::State& state, InstructionSet set, int lanes, bool ground, bool poses) {
  if (!available(set)) return state.SkipWithError("this processor lacks the instruction set");
  const Skeleton rig = fixtures::humanoid();
  const Clip clip = fixtures::random_clip({.joints = int(rig.joints.size())});
  CrowdSettings settings;
  settings.capacity = int(state.range(0));
  settings.instruction_set = set;
  settings.lanes = lanes;
  settings.ground = ground;
  settings.model_poses = poses;
  const auto crowd = crowd_of(rig, settings);
  for (int i = 0; i < settings.capacity; ++i) {
    (void)crowd->play(i, {});
    (void)SamplingJob<float>{&clip, 0.01 * i, crowd->jets(i)}.Run();
  }
  for (auto _ : state) benchmark::DoNotOptimize(crowd->step(kStep));
  per_character(state, settings.capacity);
}

/// The two kernels of a batch of 16 by themselves: their clips to jets, or the residual of these (torques and
/// comparison; no support, no poses).
void crowd_kernel(benchmark::State& state, bool sampling) {
  if (!available(InstructionSet::kAvx512)) return state.SkipWithError("this processor lacks AVX-512");
  const Skeleton rig = fixtures::humanoid();
  const int joints = int(rig.joints.size());
  const Clip clip = fixtures::random_clip({.joints = joints});
  CrowdSettings settings;
  settings.ground = false;
  const CrowdRig crowd_rig(rig, settings);
  struct alignas(64) Line {
    float numbers[16];
  };
  std::vector<CrowdTrack> tracks;
  for (int i = 0; i < 16; ++i) tracks.push_back({&clip, 0.01 * i, {}});
  const std::vector<std::uint8_t> all(16, 1);
  const auto instant = std::make_unique<crowd_kernels::Instant>();
  std::vector<Line> rows(crowd_kernels::row_bytes(joints) / sizeof(Line));
  std::vector<Line> scratch(
      (crowd_kernels::sample_scratch_bytes(joints) + check_kernels::check_scratch_bytes(joints, joints, 0)) /
      sizeof(Line));
  std::vector<Line> torque(crowd_rig.tree.dofs), limits(crowd_rig.tree.dofs), peak(1), velocity(3);
  const crowd_kernels::JetRows out{rows[0].numbers, joints, joints, joints, scratch.data()};
  check_kernels::Batch batch;
  batch.rows = rows[0].numbers;
  batch.inverse_plus = batch.inverse_minus = limits[0].numbers;
  batch.torque = torque[0].numbers;
  batch.peak = peak[0].numbers;
  batch.velocity = velocity[0].numbers;
  batch.scratch = scratch.data();
  const auto sample = [&] {
    set_instant(tracks, all, *instant);
    crowd_kernels::avx512::sample16(*instant, out);
  };
  sample();
  for (auto _ : state) {
    if (sampling)
      sample();
    else
      check_kernels::avx512::check16(crowd_rig.view, batch);
    benchmark::ClobberMemory();
  }
  per_character(state, 16);
}

/// Limp humanoids in flight, one world: every one is solved in every step.
void flight(benchmark::State& state, bool limits) {
  const int characters = int(state.range(0));
  Skeleton rig = fixtures::humanoid();
  for (Joint& joint : rig.joints) {
    if (!limits) continue;
    joint.swing_limit = joint.type == JointType::kBall ? 1 : -1;
    joint.swing_axis = -Vec3<double>::UnitZ();
    joint.twist_lower = -0.7;
    joint.twist_upper = 0.7;
  }
  WorldSettings settings;
  settings.ground = false;
  World<float> world(settings);
  Status status;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<std::vector<JointJet<float>>> starts;
  for (int n = 0; n < characters; ++n) {
    CharacterSettings limp;
    limp.root = RootDrive::kFree;
    limp.strength = 0;
    if (world.add_character(rig, limp, status) < 0) return state.SkipWithError(status.reason);
    std::vector<JointJet<float>>& jets = starts.emplace_back(rig.joints.size());
    for (std::size_t i = 0; i < jets.size(); ++i) {
      jets[i].rotation = rig.joints[i].rest.rotation.cast<float>();
      jets[i].translation = rig.joints[i].rest.translation.cast<float>();
      jets[i].omega = {normal(random), normal(random), normal(random)};
    }
    jets[0].translation.x() = 5 * float(n);
  }
  int frame = 0;
  for (auto _ : state) {
    if (frame++ % 60 == 0)
      for (int n = 0; n < characters; ++n) {
        (void)world.character(n).set_target(starts[n]);
        (void)world.character(n).reset();
      }
    benchmark::DoNotOptimize(world.step(float(kStep)));
  }
  per_character(state, characters);
}

/// Characters of a world on one clip, each at a moment of its own, in so many columns.
struct OnClip {
  Skeleton rig = fixtures::humanoid();
  Clip clip = fixtures::swaying_clip(rig, 1, 0.05);
  World<float> world;
  std::vector<JointJet<float>> jets;
  int characters, columns;
  float apart;  ///< m
  Status status;

  OnClip(int count, int of_row, float spacing, bool batches)
      : world(settings(batches)),
        jets(rig.joints.size()),
        characters(count),
        columns(of_row),
        apart(spacing) {
    for (int n = 0; n < characters; ++n)
      if (world.add_character(rig, {}, status) < 0) return;
    aim(0);
    for (int n = 0; n < characters; ++n) (void)world.character(n).reset();
  }
  static WorldSettings settings(bool batches) {
    WorldSettings chosen;
    chosen.batches = batches;
    return chosen;
  }
  void aim(double time) {
    for (int n = 0; n < characters; ++n) {
      (void)SamplingJob<float>{&clip, time + 0.1 * n, jets}.Run();
      const int row = n / columns, column = n % columns;
      jets[0].translation += Vec3<float>(apart * float(row), apart * float(column), 0);
      (void)world.character(n).set_target(jets);
    }
  }
};

/// Steps of those: what after(n) adds up over them, a step and character.
template <class After>
void step_on_clip(benchmark::State& state, OnClip& scene, const char* counter, const After& after) {
  if (!scene.status) return state.SkipWithError(scene.status.reason);
  double time = 0, sum = 0;
  for (auto _ : state) {
    state.PauseTiming();
    for (int n = 0; n < scene.characters && time > 0; ++n) sum += after(scene.world.character(n));
    scene.aim(time += kStep);
    state.ResumeTiming();
    benchmark::DoNotOptimize(scene.world.step(float(kStep)));
  }
  state.counters[counter] = sum / double(scene.characters) / double(state.iterations());
  per_character(state, scene.characters);
}

/// Their right arms hang limp: all have the same few unknowns. `twice`: every second one's left arm instead.
void limp_arm(benchmark::State& state, bool twice) {
  OnClip scene(int(state.range(0)), 1, 5, true);
  for (int n = 0; n < scene.characters && scene.status; ++n) {
    const std::string side = twice && n % 2 == 1 ? "_l" : "_r";
    for (const std::string part : {"upperarm", "forearm", "hand"})
      if (!scene.world.character(n).set_strength(scene.rig.find((part + side).c_str()), 0.0f))
        return state.SkipWithError("no such joint");
  }
  step_on_clip(state, scene, "unknowns",
               [](const Character<float>& c) { return double(c.report().unknown_dofs); });
}

/// Undisturbed, 2.5 m apart: a world's step alone, poses and motion given.
void world_frame(benchmark::State& state, bool batches) {
  const int characters = int(state.range(0));
  OnClip scene(characters, std::max(1, int(std::sqrt(double(characters)))), 2.5f, batches);
  step_on_clip(state, scene, "solved", [](const Character<float>& c) { return double(!c.on_animation()); });
}

/// A population on a grid, of which 5 % are hit at the chest every second. The whole frame on so many
/// threads: time of each frame as the host sees it, after a second to fill the world.
void population_frame(benchmark::State& state, double hits_per_second, int threads) {
  const int characters = int(state.range(0));
  const Skeleton rig = fixtures::humanoid();
  const Clip clip = fixtures::swaying_clip(rig, 1, 0.05);
  PopulationSettings settings;
  settings.crowd.capacity = characters;
  settings.crowd.chunks = 8 * threads;
  settings.world.workers = threads;
  settings.character.root = RootDrive::kAssisted;  // so that a hit at the chest is one
  settings.places = std::clamp(characters / 10, std::min(characters, 16), characters);
  Status status;
  const auto people = Population::create(rig, settings, status);
  if (!people) return state.SkipWithError(status.reason);
  const int columns = std::max(1, int(std::sqrt(double(characters))));
  for (int i = 0; i < characters; ++i) {
    const int row = i / columns, column = i % columns;
    Transform<float> place;
    place.translation = {2.5f * float(row), 2.5f * float(column), 0};
    (void)people->play(i, {&clip, 0.013 * i, place});
  }
  JobSystem jobs(threads);
  std::mt19937 random(1);
  double due = 0;
  std::vector<double> milliseconds;
  double solved = 0;
  const auto frame = [&] {
    for (due += hits_per_second * characters * kStep; due >= 1; --due) {
      const float angle = float(random() % 628) / 100;
      (void)people->push(int(random() % unsigned(characters)), 0,
                         {60 * std::cos(angle), 60 * std::sin(angle), 0});
    }
    (void)people->step(float(kStep), jobs.parallel_for());
  };
  for (int n = 0; n < 60; ++n) frame();
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    frame();
    milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    solved += people->solved_count();
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  state.counters["median_ms"] = milliseconds[milliseconds.size() / 2];
  state.counters["p99_ms"] = milliseconds[milliseconds.size() * 99 / 100];
  state.counters["in_world"] = solved / double(milliseconds.size());
  per_character(state, characters);
}

/// Limp figures that fall upon each other, from the first touch to the heap at rest: 2 s, then anew. Counters
/// are of single steps of all of them, processor time.
void pile(benchmark::State& state) {
  constexpr int kRun = 120;  // steps
  const int figures = int(state.range(0));
  const Skeleton rig = fixtures::humanoid();
  const auto world = fixtures::pile_of(figures);
  std::vector<double> microseconds;
  for (auto _ : state) {
    if (!microseconds.empty() && microseconds.size() % kRun == 0) {
      state.PauseTiming();
      fixtures::drop_pile(*world, rig, figures);
      state.ResumeTiming();
    }
    const std::clock_t begin = std::clock();
    benchmark::DoNotOptimize(world->step(float(kStep)));
    microseconds.push_back(1e6 * double(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  std::sort(microseconds.begin(), microseconds.end());
  state.counters["p50_us"] = microseconds[microseconds.size() / 2];
  state.counters["max_us"] = microseconds.back();
}

constexpr InstructionSet kBaseline = InstructionSet::kBaseline, kAvx2 = InstructionSet::kAvx2,
                         kAvx512 = InstructionSet::kAvx512;

BENCHMARK(playback)->Arg(16)->Arg(1000)->Arg(10000);
BENCHMARK_CAPTURE(crowd_check, residual_baseline_8, kBaseline, 8, false, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_baseline_16, kBaseline, 16, false, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_avx2_8, kAvx2, 8, false, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_avx2_16, kAvx2, 16, false, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_avx512_8, kAvx512, 8, false, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_avx512_16, kAvx512, 16, false, false)->Arg(16)->Arg(64)->Arg(1024);
BENCHMARK_CAPTURE(crowd_check, residual_support_avx512_16, kAvx512, 16, true, false)->Arg(64);
BENCHMARK_CAPTURE(crowd_check, residual_support_pose_avx512_16, kAvx512, 16, true, true)->Arg(64);
BENCHMARK_CAPTURE(crowd_kernel, sample_avx512_16, true);
BENCHMARK_CAPTURE(crowd_kernel, residual_avx512_16, false);
BENCHMARK_CAPTURE(crowd_frame, baseline_8, kBaseline, 8)->Arg(1000);
BENCHMARK_CAPTURE(crowd_frame, avx2_8, kAvx2, 8)->Arg(1000);
BENCHMARK_CAPTURE(crowd_frame, avx512_16, kAvx512, 16)->Arg(16)->Arg(1000)->Arg(10000)->Arg(100000);

BENCHMARK_CAPTURE(flight, no_limits, false)->Arg(64);
BENCHMARK_CAPTURE(flight, limits, true)->Arg(64);

BENCHMARK_CAPTURE(limp_arm, one_set, false)->Arg(64);
BENCHMARK_CAPTURE(limp_arm, two_sets, true)->Arg(64);

BENCHMARK_CAPTURE(world_frame, alone, false)->Arg(1000);
BENCHMARK_CAPTURE(world_frame, batches, true)->Arg(16)->Arg(1000);

BENCHMARK(pile)->Arg(3)->Arg(10)->Arg(30)->Iterations(120)->Unit(benchmark::kMicrosecond);

BENCHMARK_CAPTURE(population_frame, hit_4_threads, 0.05, 4)->Arg(1000)->Iterations(600)->UseRealTime();
BENCHMARK_CAPTURE(population_frame, hit_1_thread, 0.05, 1)
    ->RangeMultiplier(10)
    ->Range(10, 100000)
    ->Iterations(30)
    ->UseRealTime();
BENCHMARK_CAPTURE(population_frame, undisturbed_1_thread, 0, 1)
    ->RangeMultiplier(10)
    ->Range(10, 100000)
    ->Iterations(60)
    ->UseRealTime();

}  // namespace
}  // namespace sinew
