// A standing character follows a butterfly with its spine, neck and head, and after a second reaches for it,
// too. Both correct the clip's jets, with exact velocities and accelerations.
// Usage: look_at ASSET.sinew [SECONDS, at least 4]
#include <sinew/animation/inverse_kinematics.h>
#include <sinew/animation/look_at_job.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

/// Where it flies, m: a loop in front of the right shoulder. Its rates come with it.
sinew::MovingVector<float> butterfly(double time) {
  const auto swing = [&](float middle, float amplitude, float rate) {  // m, m, rad/s
    const float s = amplitude * std::sin(rate * float(time)), c = amplitude * std::cos(rate * float(time));
    return sinew::TimeJet<float>(middle + s, rate * c, -rate * rate * s);
  };
  return {swing(0.38f, 0.06f, 1.9f), swing(-0.22f, 0.18f, 1.3f), swing(1.5f, 0.1f, 2.3f)};
}

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "look_at: %s: %s\n", what, why);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: look_at ASSET.sinew [SECONDS]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  const int stand = asset.find_clip("stand");
  if (stand < 0) return fail(argv[1], "the asset has no clip stand");
  const double seconds = argc > 2 ? std::max(4.0, std::atof(argv[2])) : 6;

  // Set-up: who looks, and which limb reaches, by the roles of joints.
  const sinew::Skeleton& skeleton = asset.skeleton;
  sinew::LookChain<float> chain;
  if (sinew::Status s = sinew::find_look_chain(skeleton, chain); !s) return fail(argv[1], s.reason);
  sinew::TwoBoneJob<float> arm;
  arm.upper = skeleton.find(sinew::Role::kUpperArmR);
  arm.middle = skeleton.find(sinew::Role::kForearmR);
  arm.end = skeleton.find(sinew::Role::kHandR);
  if (arm.upper < 0 || arm.middle < 0 || arm.end < 0) return fail(argv[1], "the character has no right arm");
  arm.pole = sinew::still<float>({-0.3f, -0.5f, -1});  // where the elbow points: down, out and a little back
  arm.keep_end = false;                                // the hand goes on from the forearm as in the clip
  std::vector<int> parents;
  for (const sinew::Joint& joint : skeleton.joints) parents.push_back(joint.parent);

  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(skeleton, {}, status));
  if (!status) return fail(argv[1], status.reason);
  std::vector<sinew::JointJet<float>> jets(skeleton.joints.size());
  sinew::LookState<float> look_state;  // what a look remembers from frame to frame
  sinew::SmoothInput<float> reach;     // 0 … 1: the game steps it, the hand follows smoothly
  constexpr float h = 1 / 60.f, kHalfLife = 0.15f;
  double worst_look = 0, worst_reach = 0;  // rad, m
  int solved = 0;
  for (int frame = 0; frame <= seconds * 60; ++frame) {
    const double now = frame / 60.0;
    const sinew::MovingVector<float> target = butterfly(now);
    status = sinew::SamplingJob<float>{&asset.clips[stand], now, jets}.Run();
    if (!status) return fail("stand", status.reason);

    // The look first: it carries the shoulders, from which the arm then reaches.
    sinew::LookAtJob<float> look{parents, jets, &chain, &look_state, target};
    look.step = frame == 0 ? 0 : h;
    if (status = look.Run(); !status) return fail("look", status.reason);
    reach.step(now < 1 ? 0.f : 1.f, sinew::SmoothInput<float>::pole_of(kHalfLife), h);
    arm.parents = parents;
    arm.jets = jets;
    arm.target = target;
    arm.weight = reach.x;
    if (status = arm.Run(); !status) return fail("arm", status.reason);

    status = hero.set_target(jets);
    if (status) status = frame == 0 ? hero.reset() : world.step(h);
    if (!status) return fail("step", status.reason);
    solved += hero.report().unknown_dofs > 0;

    // What the world shows, not what was asked of it: how far are gaze and hand off?
    const sinew::Vec3<float> there = sinew::value_of(target);
    const sinew::Transform<float>& head = hero.model()[chain.joints[chain.count - 1]];
    const sinew::Vec3<float> gaze = head.rotation * chain.axis, wanted = there - head.translation;
    const double look_off = std::atan2(double(gaze.cross(wanted).norm()), double(gaze.dot(wanted)));
    const double hand_off = double((hero.model()[arm.end].translation - there).norm());
    worst_look = std::max(worst_look, look_off);
    if (now > 3) worst_reach = std::max(worst_reach, hand_off);
    if (frame % 30 == 0)
      std::printf("%5.2f s  gaze off by %.1e rad, hand by %.3f m, unknown DOFs %d\n", now, look_off, hand_off,
                  hero.report().unknown_dofs);
  }
  if (worst_look > 0.001) return fail("look", "the gaze is more than 0.001 rad off the butterfly");
  if (worst_reach > 0.001) return fail("arm", "the hand is more than 1 mm off the butterfly");
  if (solved > 0) return fail("world", "something had to be solved");
  std::printf("gaze within %.1e rad, hand within %.1e mm; nothing was solved\n", worst_look,
              1000 * worst_reach);
  return 0;
}
