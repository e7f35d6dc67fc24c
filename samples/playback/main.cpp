// Plays the first clip of an asset and prints where the root is. Usage: playback ASSET.sinew [SECONDS]
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: playback ASSET.sinew [SECONDS]\n");
    return 2;
  }
  sinew::Asset asset;
  const sinew::Status loaded = sinew::load_asset(argv[1], asset);
  if (!loaded || asset.clips.empty()) {
    std::fprintf(stderr, "playback: %s: %s\n", argv[1], loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const double seconds = argc > 2 ? std::atof(argv[2]) : 2;
  sinew::Status status;
  sinew::World<float> world({});
  const int hero = world.add_character(asset.skeleton, {}, status);
  if (!status) return 1;
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  const sinew::Clip& clip = asset.clips.front();
  for (int frame = 0; frame <= seconds * 60; ++frame) {
    sinew::SamplingJob<float>{&clip, frame / 60.0, jets}.Run();
    world.character(hero).set_target(jets);
    if (frame == 0)
      world.character(hero).reset();
    else
      world.step(1 / 60.f);
    const auto& root = world.character(hero).model()[0].translation;
    if (frame % 30 == 0)
      std::printf("%5.2f s  root %6.2f %6.2f %6.2f m  unknown DOFs %d\n", frame / 60.0, double(root.x()),
                  double(root.y()), double(root.z()), world.character(hero).report().unknown_dofs);
  }
  return 0;
}
