// A walk whose upper body runs for a while, breathing on top: a masked override and an additive layer that
// come and go. Velocities and accelerations come out exact, so that the world has nothing to solve meanwhile.
// Usage: blend ASSET.sinew [SECONDS]
#include <sinew/animation/blending_job.h>
#include <sinew/animation/crossfade.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace {

using Jets = std::vector<sinew::JointJet<float>>;

/// What the character wants at any time; keeps nothing from one frame to the next.
struct Mixer {
  const sinew::Clip &walk, &run, &stand;
  double end;                                  ///< s
  std::vector<float> mask;                     ///< [joint] 1: the upper body
  std::vector<sinew::Transform<float>> rest;   ///< [joint] says which of ±q is meant: see BlendingJob
  std::vector<sinew::Transform<float>> still;  ///< [joint] a breath is the difference from this
  Jets lower, upper, breath;

  Mixer(const sinew::Asset& asset, const sinew::JointMask& reach, double seconds)
      : walk(asset.clips[asset.find_clip("walk")]),
        run(asset.clips[asset.find_clip("run")]),
        stand(asset.clips[asset.find_clip("stand")]),
        end(seconds),
        mask(asset.skeleton.joints.size()),
        still(mask.size()),
        lower(mask.size()),
        upper(mask.size()),
        breath(mask.size()) {
    reach.write<float>(mask);
    for (const sinew::Joint& joint : asset.skeleton.joints) rest.push_back(joint.rest.cast<float>());
    (void)sinew::SamplingJob<float>{&stand, 0, {}, still}.Run();  // clips of an asset are valid
  }
  sinew::Status sample(double time, Jets& out) {
    // The run takes as long strides as the walk: its clip's time is a motion, whose rate goes into velocities
    // and accelerations.
    const double pace = double(run.duration) / double(walk.duration);
    sinew::Status status = sinew::SamplingJob<float>{&walk, time, lower}.Run();
    if (status) status = sinew::SamplingJob<float>{&run, {time * pace, pace}, upper}.Run();
    if (status) status = sinew::SamplingJob<float>{&stand, time, breath}.Run();
    if (!status) return status;
    sinew::subtract_reference<float>(still, breath, breath);

    // In from 0.5 s on, out in the last second, in 0.5 s each. Weights bring their rates along: those of the
    // way out are of time that runs backwards.
    using Weight = sinew::EaseWeight<float>;
    const Weight in = Weight::at(float(time - 0.5), 0.5f), left = Weight::at(float(end - 0.5 - time), 0.5f);
    const sinew::TimeJet<float> weight =
        in * sinew::TimeJet<float>(left.value, -left.rate, left.acceleration);
    std::array<sinew::BlendLayer<float>, 3> layers;
    layers[0].jets = lower;
    layers[1] = {upper, weight, mask, sinew::BlendMode::kOverride};
    layers[2] = {breath, weight, mask, sinew::BlendMode::kAdditive};
    return sinew::BlendingJob<float>{layers, rest, out}.Run();
  }
};

bool same_bits(const sinew::JointJet<float>& a, const sinew::JointJet<float>& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() && a.omega == b.omega && a.alpha == b.alpha &&
         a.translation == b.translation && a.velocity == b.velocity && a.acceleration == b.acceleration;
}

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "blend: %s: %s\n", what, why);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: blend ASSET.sinew [SECONDS]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  for (const char* clip : {"walk", "run", "stand"})
    if (asset.find_clip(clip) < 0) return fail(clip, "the asset has no such clip");
  const int upper_body = asset.find_mask("upper_body");
  if (upper_body < 0) return fail("upper_body", "the asset has no such mask");
  Mixer mixer(asset, asset.masks[upper_body], argc > 2 ? std::atof(argv[2]) : 4);
  const std::size_t joints = asset.skeleton.joints.size();

  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  if (!status) return fail(argv[1], status.reason);
  constexpr float h = 1 / 60.f, little = 1 / 1920.f;  // s
  Jets jets(joints), before(joints), after(joints);
  int solved = 0, touched = 0;
  float off = 0, fastest = 0, alpha_off = 0, strongest = 0;
  for (int frame = 0; frame <= mixer.end * 60; ++frame) {
    const double now = frame / 60.0;
    for (auto& [time, out] : {std::pair{now - little, &before}, {now + little, &after}, {now, &jets}})
      if (status = mixer.sample(time, *out); !status) return fail("layers", status.reason);
    for (std::size_t j = 0; j < joints; ++j) {
      touched += mixer.mask[j] == 0 && !same_bits(jets[j], mixer.lower[j]);
      if (mixer.mask[j] == 0) continue;
      // Are the derivatives those of the pose that is shown? Differences of it over ±0.5 ms say so.
      const Eigen::AngleAxisf turn(before[j].rotation.conjugate() * after[j].rotation);
      off = std::max(off, (turn.angle() / (2 * little) * turn.axis() - jets[j].omega).norm());
      alpha_off =
          std::max(alpha_off, ((after[j].omega - before[j].omega) / (2 * little) - jets[j].alpha).norm());
      fastest = std::max(fastest, jets[j].omega.norm());
      strongest = std::max(strongest, jets[j].alpha.norm());
    }
    status = hero.set_target(jets);
    if (status) status = frame == 0 ? hero.reset() : world.step(h);
    if (!status) return fail("step", status.reason);
    solved += hero.report().unknown_dofs > 0;
    if (frame % 30 == 0)
      std::printf("%5.2f s  busiest muscle at %3.0f %%, unknown DOFs %d\n", now,
                  100 * double(*std::max_element(hero.load().begin(), hero.load().end())),
                  hero.report().unknown_dofs);
  }
  std::printf("velocities off by %.4f of %.1f rad/s, accelerations by %.2f of %.0f rad/s2\n", double(off),
              double(fastest), double(alpha_off), double(strongest));
  if (touched > 0) return fail("mask", "a joint outside of it is not the walk's, bit for bit");
  if (off > 0.01f * fastest || alpha_off > 0.01f * strongest)
    return fail("layers", "derivatives are not the pose's");
  if (solved > 0) return fail("world", "something had to be solved");
  std::puts("legs are the walk's to the bit; nothing was solved");
  return 0;
}
