// What surroundings cost a figure that nothing touches, and what a step costs that can hardly be solved.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "character/scenes.h"
#include "fixtures/pile.h"

namespace sinew {
namespace {

constexpr float kStep = 1.f / 60;

/// m, of the nth in rows of so many.
Vec3<double> in_rows(int n, int row, double apart) {
  const std::div_t at = std::div(n, row);
  return {apart * at.rem, apart * at.quot, 0};
}

Collider box_at(const Vec3<double>& place) {
  Collider box;
  box.shape = Shape::kBox;
  box.size = Vec3<double>::Constant(0.25);
  box.local.translation = place + Vec3<double>(0, 0, 0.25);
  return box;
}

/// A hundred figures that idle 4 m apart, with so many boxes 200 m away, and one 0.6 m beside each or none.
void beside(benchmark::State& state) {
  constexpr int kSide = 10, kRow = 70;
  constexpr double kApart = 4, kFar = 200, kNear = 0.85;
  World<float> world{WorldSettings()};
  for (int n = 0; n < int(state.range(0)); ++n)
    (void)world.add_obstacle(box_at(in_rows(n, kRow, 1) + Vec3<double>(kFar, 0, 0)));
  for (int n = 0; n < kSide * kSide && state.range(1) != 0; ++n)
    (void)world.add_obstacle(box_at(in_rows(n, kSide, kApart) + Vec3<double>(kNear, 0, 0)));
  const Skeleton body = fixtures::humanoid();
  Status status;
  for (int n = 0; n < kSide * kSide; ++n) (void)world.add_character(body, {}, status);
  double time = 0;
  bool begun = false;
  int solved = 0;
  for (auto _ : state) {
    state.PauseTiming();
    for (int n = 0; n < kSide * kSide; ++n) {
      std::vector<JointJet<float>> jets = fixtures::idle<float>(body, time + 0.01 * n);
      jets[0].translation += in_rows(n, kSide, kApart).cast<float>();
      (void)world.character(n).set_target(jets);
      if (!begun) (void)world.character(n).reset();
    }
    begun = true;
    time += kStep;
    state.ResumeTiming();
    benchmark::DoNotOptimize(world.step(kStep));
    for (int n = 0; n < kSide * kSide; ++n) solved += world.character(n).report().substeps > 0;
  }
  state.counters["solved"] = double(solved) / double(state.iterations()) / (kSide * kSide);
  state.counters["per character"] = benchmark::Counter(
      kSide * kSide, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Six limp figures that begin in one place, 20 steps, with a budget of so many passes a step.
void one_place(benchmark::State& state) {
  constexpr int kFigures = 6;
  WorldSettings settings;
  settings.accuracy.max_passes = int(state.range(0));
  const auto world = fixtures::pile_of(kFigures, settings);
  fixtures::put_in_one_place(*world, fixtures::humanoid(), kFigures);
  int most_passes = 0;
  double most_ms = 0;
  for (auto _ : state) {
    const std::clock_t begin = std::clock();
    benchmark::DoNotOptimize(world->step(kStep));
    most_ms = std::max(most_ms, 1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC);
    most_passes = std::max(most_passes, world->character(0).report().outer_passes);
  }
  state.counters["max_ms"] = most_ms;
  state.counters["max_passes"] = most_passes;
}

/// Twenty figures that idle so many decimetres apart, assisted roots, all hit at the chest at once: 2 s, then
/// anew. Counters are of single steps of all of them, processor time.
void hit_at_once(benchmark::State& state) {
  constexpr int kFigures = 20, kRow = 5, kRun = 120;        // steps
  constexpr double kWeak = 80, kStrong = 160, kTurn = 2.4;  // N·s; rad from one to the next: every way
  const double apart = double(state.range(0)) / 10;
  World<float> world{WorldSettings()};
  const Skeleton body = fixtures::humanoid();
  CharacterSettings assisted;
  assisted.root = RootDrive::kAssisted;
  Status status;
  for (int n = 0; n < kFigures; ++n)
    if (world.add_character(body, assisted, status) < 0) return state.SkipWithError(status.reason);
  const int chest = body.find("chest");
  int frame = 0;
  std::vector<double> microseconds;
  for (auto _ : state) {
    state.PauseTiming();
    for (int n = 0; n < kFigures; ++n) {
      std::vector<JointJet<float>> jets =
          fixtures::idle<float>(body, double(frame) * double(kStep) + 0.01 * n);
      jets[0].translation += in_rows(n, kRow, apart).cast<float>();
      Character<float> c = world.character(n);
      (void)c.set_target(jets);
      if (frame != 0) continue;
      (void)c.reset();
      const double hit = kWeak + (kStrong - kWeak) * n / kFigures;
      (void)c.apply_impulse(
          chest, c.model()[chest].translation,
          Vec3<double>(hit * std::cos(kTurn * n), hit * std::sin(kTurn * n), 0).cast<float>());
    }
    frame = (frame + 1) % kRun;
    state.ResumeTiming();
    const std::clock_t begin = std::clock();
    benchmark::DoNotOptimize(world.step(kStep));
    microseconds.push_back(1e6 * double(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  std::sort(microseconds.begin(), microseconds.end());
  state.counters["p50_us"] = microseconds[microseconds.size() / 2];
  state.counters["p99_us"] = microseconds[microseconds.size() * 99 / 100];
  state.counters["max_us"] = microseconds.back();
}

BENCHMARK(beside)->Args({0, 0})->Args({5000, 0})->Args({0, 1})->Iterations(120)->Unit(
    benchmark::kMicrosecond);
BENCHMARK(hit_at_once)->Arg(8)->Arg(200)->Iterations(240)->Unit(benchmark::kMicrosecond);
BENCHMARK(one_place)->Arg(100)->Arg(100000)->Iterations(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
