// An effect of one's own (grab.h) pulls at the chest of a standing character, harder and harder: muscles bear
// it, until what they cannot bear is simulated. Then it lifts the character, limp.
// Usage: own_effect ASSET.sinew
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "grab.h"

namespace {

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "own_effect: %s: %s\n", what, why);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: own_effect ASSET.sinew\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  const int stand = asset.find_clip("stand"), chest = asset.skeleton.find(sinew::Role::kChest);
  if (stand < 0) return fail(argv[1], "the asset has no clip stand");
  if (chest < 0) return fail(argv[1], "the character has no chest");

  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  if (!status) return fail(argv[1], status.reason);
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  status = sinew::SamplingJob<float>{&asset.clips[stand], 0, jets}.Run();
  if (status) status = hero.set_target(jets);
  if (status) status = hero.reset();
  if (!status) return fail("stand", status.reason);
  GrabSettings settings;
  settings.joint = chest;
  settings.at = asset.skeleton.joints[chest].center_of_mass;
  settings.to = hero.model()[chest].cast<double>() * settings.at;
  auto made = std::make_unique<Grab<float>>(settings);
  Grab<float>& grab = *made;  // the world owns it; the address stays good
  if (status = world.add_effect(0, std::move(made)); !status) return fail("grab", status.reason);

  // Pulled forward, harder and harder: the back bears it, then it gives way.
  grab.settings.to.x() += 1;
  double borne = 0, overcome = 0;  // N/m, over 1 m: N
  for (int frame = 1; frame <= 240 && overcome == 0; ++frame) {
    grab.settings.stiffness = 5.0 * frame;
    status = sinew::SamplingJob<float>{&asset.clips[stand], frame / 60.0, jets}.Run();
    if (status) status = hero.set_target(jets);
    if (status) status = world.step(1 / 60.f);
    if (!status) return fail("step", status.reason);
    (hero.report().unknown_dofs == 0 ? borne : overcome) = grab.settings.stiffness;
  }
  std::printf("muscles bear a pull of %.0f N; %.0f N overcomes %d degrees of freedom\n", borne, overcome,
              hero.report().unknown_dofs);

  // Limp, lifted by the chest: the spring becomes as long as the weight makes it.
  status = hero.set_strength(0);
  if (status) status = hero.set_root_drive(sinew::RootDrive::kFree);
  if (!status) return fail("limp", status.reason);
  grab.settings.stiffness = 10000;
  grab.settings.damping = 300;
  grab.settings.to = {0, 0, 2.5};
  double force = 0;  // N, upwards: the mean of the last 5 s, since it swings
  for (int frame = 0; frame < 900; ++frame) {
    if (status = world.step(1 / 60.f); !status) return fail("step", status.reason);
    const sinew::Vec3<double> at = hero.model()[chest].cast<double>() * settings.at;
    if (frame >= 600) force += grab.settings.stiffness * (grab.settings.to - at).z() / 300;
  }
  const double weight = asset.skeleton.total_mass() * 9.81;
  std::printf("limp it hangs from %.0f N; it weighs %.0f N\n", force, weight);
  if (!(borne > 0) || !(overcome > 0)) return fail("grab", "muscles bore nothing, or everything");
  if (std::abs(force - weight) > 0.01 * weight)
    return fail("grab", "it hangs from another force than its weight");
  return 0;
}
