// One undisturbed frame of a character in a world: residual pass, comparison with the muscles and model pose,
// without sampling and with it, and plain playback of the same: sampling of poses and model pose.
#include <benchmark/benchmark.h>

#include "character/scenes.h"
#include "fixtures/clips.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/sampling_job.h"

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

void sampled_frame(benchmark::State& state) {
  fixtures::Playing<float> scene;
  (void)scene.character().set_strength(1e6f);
  const Clip clip = fixtures::swaying_clip(scene.skeleton, 1);
  std::vector<JointJet<float>> jets(scene.skeleton.joints.size());
  double time = 0;
  for (auto _ : state) {
    (void)SamplingJob<float>{&clip, time += 1 / 60.0, jets, {}}.Run();
    (void)scene.character().set_target(jets);
    benchmark::DoNotOptimize(scene.world.step(1 / 60.f));
  }
  if (!scene.character().on_animation()) state.SkipWithError("the character left its animation");
}

void plain_playback(benchmark::State& state) {
  const Skeleton skeleton = fixtures::humanoid();
  const Clip clip = fixtures::swaying_clip(skeleton, 1);
  std::vector<Transform<float>> poses(skeleton.joints.size()), model(poses.size());
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  double time = 0;
  for (auto _ : state) {
    (void)SamplingJob<float>{&clip, time += 1 / 60.0, {}, poses}.Run();
    (void)ModelPoseJob<float>{parents, {}, poses, {}, model}.Run();
    benchmark::ClobberMemory();
  }
}

BENCHMARK(undisturbed_frame);
BENCHMARK(sampled_frame);
BENCHMARK(plain_playback);

}  // namespace
}  // namespace sinew
