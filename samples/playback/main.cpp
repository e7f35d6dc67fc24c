// Plays the first clip of an asset and prints where the root is, what the clip reports on its way, and its
// curves. Usage: playback ASSET.sinew [SECONDS]
#include <sinew/animation/curve_job.h>
#include <sinew/animation/event_job.h>
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
  std::vector<sinew::TimeJet<float>> curves(asset.curve_slots.size());
  std::vector<sinew::EventHit> hits(16);
  for (int frame = 0; frame <= seconds * 60; ++frame) {
    const double now = frame / 60.0, before = now - 1 / 60.0;
    status = sinew::SamplingJob<float>{&clip, now, jets}.Run();
    if (status) status = sinew::CurveJob<float>{&clip, now, asset.curve_slots, curves}.Run();
    sinew::EventSink sink{hits};
    sinew::EventJob events;
    events.events = clip.events;
    events.duration = double(clip.duration);
    events.loops = clip.loops;
    events.from = frame == 0 ? now : before;
    events.to = now;
    events.starts = frame == 0;
    events.step = 1 / 60.f;
    events.out = &sink;
    if (status) status = events.Run();
    for (int k = 0; k < sink.count; ++k)  // a game switches over sinew::event_name("step")
      for (const std::string& name : asset.event_names)
        if (sinew::event_name(name) == hits[std::size_t(k)].event->name)
          std::printf("%5.2f s  %s, %.0f ms before this frame\n", now, name.c_str(),
                      1000 * double(hits[std::size_t(k)].seconds_ago));
    if (status) status = world.character(hero).set_target(jets);
    if (status) status = frame == 0 ? world.character(hero).reset() : world.step(1 / 60.f);
    if (!status) break;
    const auto& root = world.character(hero).model()[0].translation;
    if (frame % 30 != 0) continue;
    std::printf("%5.2f s  root %6.2f %6.2f %6.2f m  unknown DOFs %d", now, double(root.x()), double(root.y()),
                double(root.z()), world.character(hero).report().unknown_dofs);
    for (std::size_t c = 0; c < curves.size(); ++c)
      std::printf("  %s %.2f", asset.curve_slots[c].name.c_str(), double(curves[c].value));
    std::printf("\n");
  }
  if (!status) std::fprintf(stderr, "playback: %s\n", status.reason);
  return status ? 0 : 1;
}
