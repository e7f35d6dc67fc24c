// Calls one animation job so many times, for callgrind to count: the difference between two runs is the
// calls' own. 67 joints, float; or a clip of an asset.
//
//     animation_count sample|seek|blend|inertialize|begin|mirror|feet|look|morph CALLS
//     animation_count mix_masked|override_masked|override_half|additive CALLS
//     animation_count sample|seek CALLS ASSET.sinew CLIP
//
// `sample` plays on by a hundredth of a second, `seek` jumps to and fro. Masks are 0.5, that of
// `override_half` is 0 for the first half of the joints.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/rigs.h"
#include "fixtures/clips.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/morph_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/io/asset.h"

namespace {

using namespace sinew;
using bench::look, bench::mirror_map, bench::place_feet;

/// The clip that is asked for; without joints if there is no such clip.
Clip clip_of(int argc, char** argv) {
  if (argc != 5) return fixtures::random_clip({});
  Asset asset;
  if (!load_asset(argv[3], asset)) return {};
  const int index = asset.find_clip(argv[4]);
  return index < 0 ? Clip() : asset.clips[std::size_t(index)];
}

/// A face: 52 targets that touch 2000 of 20000 vertices each.
struct Face {
  std::vector<float> positions = std::vector<float>(60000, 1.f), weights = std::vector<float>(52, 0.5f), out;
  std::vector<MorphTarget> targets;
  explicit Face(std::size_t count) : out(positions), targets(count) {
    std::vector<float> moves(positions.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
      std::fill(moves.begin(), moves.end(), 0.f);
      std::fill_n(moves.begin() + std::ptrdiff_t(1000 * k), 6000, 0.01f);
      (void)build_morph_target(moves, {}, 1e-5f, targets[k]);
    }
  }
  bool run() { return MorphJob{positions, {}, targets, weights, out}.Run().ok(); }
};

}  // namespace

int main(int argc, char** argv) {
  const bool asked = argc == 3 || argc == 5;
  const std::string job = asked ? argv[1] : "";
  const int calls = asked ? std::atoi(argv[2]) : 0;
  const Clip clip = clip_of(argc, argv);
  const int joints = clip.joint_count;
  constexpr int kShifting = 1;
  std::vector<JointJet<float>> a(joints), b(joints), out(joints);
  (void)SamplingJob<float>{&clip, 1, a}.Run();
  (void)SamplingJob<float>{&clip, 3, b}.Run();
  std::vector<float> numbers(inertial_numbers(joints, kShifting));
  InertialState<float> state{numbers, joints, kShifting};
  (void)begin_inertial<float>(a, b, 1, state);
  state.elapsed = 0.3f;
  BlendLayer<float> layers[] = {{a, {0.7f, 0, 0}}, {b, {0.3f, 0.1f, 2}}};
  std::vector<float> mask(joints, 0.5f);
  if (job == "override_half") std::fill_n(mask.begin(), joints / 2, 0.f);
  const bool over = job.starts_with("override"),
             blends = over || job == "blend" || job == "mix_masked" || job == "additive";
  if (over || job == "mix_masked") layers[1].mask = mask;
  if (over) layers[1].mode = BlendMode::kOverride;
  if (job == "additive") layers[1].mode = BlendMode::kAdditive;
  const MirrorMap<float> mirror = mirror_map(joints);
  FootState<float> feet[2];
  LookState<float> head;
  Face face(job == "morph" ? 52 : 0);
  bool ok = calls > 0 && joints > 0;
  for (int i = 0; i < calls && ok; ++i) {
    if (job == "sample")
      ok = SamplingJob<float>{&clip, 0.01 * i, out}.Run().ok();
    else if (job == "seek")
      ok = SamplingJob<float>{&clip, clip.duration * double(i * 7919 % 10007) / 10007, out}.Run().ok();
    else if (blends)
      ok = BlendingJob<float>{layers, {}, out}.Run().ok();
    else if (job == "inertialize")
      ok = InertializeJob<float>{b, &state, {}, out}.Run().ok();
    else if (job == "begin")
      ok = begin_inertial<float>(a, b, 1, state).ok();
    else if (job == "mirror")
      ok = MirrorJob<float>{&mirror, a, out}.Run().ok();
    else if (job == "feet")
      ok = place_feet(feet);
    else if (job == "look")
      ok = look(head);
    else if (job == "morph")
      ok = face.run();
    else
      ok = false;
  }
  if (ok) return 0;
  std::fputs(
      "usage: animation_count "
      "sample|seek|blend|mix_masked|override_masked|override_half|additive|inertialize|"
      "begin|mirror|feet|look|morph CALLS [ASSET.sinew CLIP]\n",
      stderr);
  return 2;
}
