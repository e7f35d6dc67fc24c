// A standing character is knocked over, falls, lies, and gets up by the clips of the asset that begin nearest
// to how it lies. Prints what the behaviour tells.
// Usage: fall_and_get_up ASSET.sinew [IMPULSE in N·s, forward]
#include <sinew/animation/sampling_job.h>
#include <sinew/behaviour/behaviour.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cstdio>
#include <cstdlib>

namespace {

const char* name(sinew::BehaviourEventKind kind) {
  switch (kind) {
    case sinew::BehaviourEventKind::kFallen:
      return "fallen";
    case sinew::BehaviourEventKind::kRising:
      return "rising";
    case sinew::BehaviourEventKind::kStanding:
      return "standing";
  }
  return "";
}

const char* why(const sinew::BehaviourEvent& event) {
  switch (event.reason) {
    case sinew::BehaviourReason::kNone:
      return "";
    case sinew::BehaviourReason::kAsked:
      return ", as it was told";
    case sinew::BehaviourReason::kBeyondReach:
      return ", no step reaches far enough";
    case sinew::BehaviourReason::kTilted:
      return ", its root is too low";
    case sinew::BehaviourReason::kNotGathered:
      return ", it did not come into the pose to rise from";
    case sinew::BehaviourReason::kLeftItsClip:
      return ", it left its clip";
    case sinew::BehaviourReason::kTookTooLong:
      return ", it took too long";
  }
  return "";
}

int fail(const char* what, const char* reason) {
  std::fprintf(stderr, "fall_and_get_up: %s: %s\n", what, reason);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: fall_and_get_up ASSET.sinew [IMPULSE]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  const int stand = asset.find_clip("stand"), chest = asset.skeleton.find(sinew::Role::kChest);
  if (stand < 0) return fail(argv[1], "the asset has no clip stand");
  if (chest < 0) return fail(argv[1], "the character has no chest");
  const float impulse = argc > 2 ? static_cast<float>(std::atof(argv[2])) : 140.f;

  // Set-up: a root that only the ground holds, and a behaviour that acts when the ground can't.
  sinew::Status status;
  sinew::World<float> world({});
  sinew::CharacterSettings settings;
  settings.root = sinew::RootDrive::kGrounded;
  settings.self_collision = true;  // arms do not pass through the trunk
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, settings, status));
  if (!status) return fail(argv[1], status.reason);
  sinew::Behaviour<float> balance(asset.skeleton, {}, status);
  if (status) status = balance.use_get_ups(asset.skeleton, asset.clips);
  if (!status) return fail(argv[1], status.reason);

  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  constexpr float h = 1 / 60.f;
  constexpr int kLongest = 30 * 60, kPush = 60, kPushed = 6;  // frames
  bool fallen = false, standing = false;
  int tries = 0;
  double lowest = 10;  // m, of the root
  for (int frame = 0; frame < kLongest && !(standing && hero.on_animation()); ++frame) {
    status = sinew::SamplingJob<float>{&asset.clips[stand], frame / 60.0, jets}.Run();
    if (status) status = balance.update(hero, jets, h);
    if (status) status = hero.set_target(jets);  // what the clip wants, or what the behaviour made of it
    if (status && frame == 0) status = hero.reset();
    if (status && frame >= kPush && frame < kPush + kPushed)
      status = hero.apply_force(chest, hero.model()[chest].translation, {impulse / (h * kPushed), 0, 0});
    if (status) status = world.step(h);
    if (!status) return fail("step", status.reason);
    lowest = std::min(lowest, hero.position().z());
    for (const sinew::BehaviourEvent& event : balance.events()) {
      std::printf("%5.2f s  %s%s\n", frame / 60.0, name(event.kind), why(event));
      fallen |= event.kind == sinew::BehaviourEventKind::kFallen;
      tries += fallen && event.kind == sinew::BehaviourEventKind::kRising;
      standing |= tries > 0 && event.kind == sinew::BehaviourEventKind::kStanding;
    }
    if (frame % 60 == 0)
      std::printf("%5.2f s  root at %.2f m, unknown DOFs %d\n", frame / 60.0, hero.position().z(),
                  hero.report().unknown_dofs);
  }
  std::printf("lay %.2f m above the ground, stands again at %.2f m; tries to get up: %d\n", lowest,
              hero.position().z(), tries);
  if (!fallen) return fail("push", "it did not fall");
  if (tries == 0) return fail("get up", "it stayed on the ground");
  if (!standing) return fail("get up", "it does not stand after 30 s");
  if (!hero.on_animation()) return fail("get up", "it is not back on its clip after 30 s");
  return 0;
}
