// Pushes a playing character at its chest after one second. Usage: hit_reaction ASSET.sinew [IMPULSE in N·s]
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: hit_reaction ASSET.sinew [IMPULSE]\n");
    return 2;
  }
  sinew::Asset asset;
  const sinew::Status loaded = sinew::load_asset(argv[1], asset);
  if (!loaded || asset.clips.empty()) {
    std::fprintf(stderr, "hit_reaction: %s: %s\n", argv[1], loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const float impulse = argc > 2 ? static_cast<float>(std::atof(argv[2])) : 90.f;
  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  int chest = asset.skeleton.find(sinew::Role::kChest);
  if (chest < 0) chest = asset.skeleton.body_count / 2;
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  int most = 0;
  for (int frame = 0; frame <= 180 && status; ++frame) {
    status = sinew::SamplingJob<float>{&asset.clips.front(), frame / 60.0, jets}.Run();
    if (status) status = hero.set_target(jets);
    if (status && frame == 0) status = hero.reset();
    if (status && frame == 60)
      status = hero.apply_impulse(chest, hero.model()[static_cast<std::size_t>(chest)].translation,
                                  {0, impulse, 0});
    if (status) status = world.step(1 / 60.f);
    most = std::max(most, hero.report().unknown_dofs);
    if (frame >= 58 && frame < 80)
      std::printf("%5.2f s  %2d of %d degrees of freedom unknown\n", frame / 60.0, hero.report().unknown_dofs,
                  hero.report().dofs);
  }
  if (!status) {
    std::fprintf(stderr, "hit_reaction: %s\n", status.reason);
    return 1;
  }
  std::printf("at most %d unknown; %s\n", most,
              hero.on_animation() ? "back on the animation" : "still off the animation");
  return 0;
}
