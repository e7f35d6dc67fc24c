// A crowd that walks; every now and then one is hit, every third of these so hard that it goes limp. Grey:
// played. Amber: some of its degrees of freedom are solved. Red: all of them. Usage: crowd ASSET.sinew
// OUT.mp4|OUT_%03d.png [CHARACTERS] [SECONDS]
#include <sinew/animation/crossfade.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>

#include "render/render.h"

namespace {

constexpr int kRate = 60;          // steps per second
constexpr double kSpacing = 2.6;   // m; nearer ones would be solved together
constexpr double kHitEvery = 0.1;  // s

/// Of a grid about as deep as wide.
int columns_of(int count) {
  return std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
}

/// The same place of a row-by-row grid whose rows walk side by side, and the same moment of the walk, every
/// run.
struct Walker {
  sinew::Transform<float> place;
  double phase = 0;  // s
};

std::vector<Walker> arranged(int count, float duration) {
  const int columns = columns_of(count);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> phase(0, duration);
  std::vector<Walker> walkers;
  for (int n = 0; n < count; ++n) {
    const int row = n / columns, column = n % columns;
    Walker& w = walkers.emplace_back();
    w.place.translation = sinew::Vec3<double>(-kSpacing * row, kSpacing * column, 0).cast<float>();
    w.phase = phase(random);
  }
  return walkers;
}

/// What the renderer shows of one character: its pose, and its state as the load that colours it.
sinew::scene::CharacterFrame frame_of(const sinew::Character<float>& c) {
  sinew::scene::CharacterFrame frame;
  frame.model.assign(c.model().begin(), c.model().end());
  frame.unknown_dofs = c.report().unknown_dofs;
  frame.total_dofs = c.report().dofs;
  const bool all = 2 * frame.unknown_dofs > frame.total_dofs;
  frame.load.assign(frame.model.size(), frame.unknown_dofs == 0 ? 0.f : all ? 1.f : 0.75f);
  frame.torque.assign(frame.model.size(), 0);
  frame.limit.assign(frame.model.size(), 0);
  return frame;
}

int run(const char* file, const char* output, int count, double seconds) {
  auto asset = std::make_shared<sinew::Asset>();
  const sinew::Status loaded = sinew::load_asset(file, *asset);
  if (!loaded || asset->clips.empty()) {
    std::fprintf(stderr, "crowd: %s: %s\n", file, loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const sinew::Clip& walk = asset->clips[static_cast<std::size_t>(std::max(0, asset->find_clip("walk")))];
  const int chest = std::max(0, asset->skeleton.find(sinew::Role::kChest));
  const std::vector<Walker> walkers = arranged(count, walk.duration);
  sinew::Status status;
  sinew::World<float> world({});
  for (int n = 0; n < count; ++n)
    if (world.add_character(asset->skeleton, {}, status) < 0) {
      std::fprintf(stderr, "crowd: %s\n", status.reason);
      return 1;
    }
  sinew::scene::Recording recording;
  recording.title = "Crowd";
  recording.frame_rate = kRate;
  recording.characters.assign(static_cast<std::size_t>(count), asset);
  // Walks backwards before the middle of the first row.
  const float middle = walkers[static_cast<std::size_t>(columns_of(count) / 2)].place.translation.y();
  recording.camera.eye = {9.f, middle - 4.f, 3.2f};
  recording.camera.target = {-2.f, middle, 0.4f};
  recording.camera.follow_character = columns_of(count) / 2;
  recording.camera.frame_automatically = false;
  std::vector<sinew::JointJet<float>> jets(asset->skeleton.joints.size());
  std::vector<double> microseconds;
  std::mt19937 random(2);
  int hits = 0, most_solved = 0;
  const int steps = static_cast<int>(seconds * kRate);
  for (int step = 0; step <= steps; ++step) {
    const double t = step / double(kRate);
    const auto begin = std::chrono::steady_clock::now();
    for (int n = 0; n < count; ++n) {
      const Walker& w = walkers[static_cast<std::size_t>(n)];
      sinew::SamplingJob<float>{&walk, t + w.phase, 1, jets}.Run();
      sinew::place_root<float>(w.place, jets[0]);
      world.character(n).set_target(jets);
      if (step == 0) world.character(n).reset();
    }
    if (t > 0.5 && t > (hits + 5) * kHitEvery) {
      sinew::Character<float> c = world.character(static_cast<int>(random() % static_cast<unsigned>(count)));
      const float angle = static_cast<float>(random() % 628) / 100, impulse = ++hits % 3 ? 60.f : 150.f;
      c.apply_impulse(chest, c.model()[static_cast<std::size_t>(chest)].translation,
                      {impulse * std::cos(angle), impulse * std::sin(angle), 0});
      if (hits % 3 == 0) {
        c.set_root_drive(sinew::RootDrive::kFree);
        c.set_strength(0.02f);
      }
    }
    if (step > 0 && !world.step(1.f / kRate)) return 1;
    microseconds.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    sinew::scene::Frame& frame = recording.frames.emplace_back();
    frame.time = t;
    int solved = 0;
    for (int n = 0; n < count; ++n) {
      frame.characters.push_back(frame_of(world.character(n)));
      solved += frame.characters.back().unknown_dofs > 0;
    }
    most_solved = std::max(most_solved, solved);
    frame.caption = std::to_string(count) + " characters, " + std::to_string(solved) + " of them solved";
  }
  std::sort(microseconds.begin(), microseconds.end());
  std::printf(
      "%d characters, %d hits, at most %d solved at once; step and sampling: median %.2f ms, slowest %.2f "
      "ms\n",
      count, hits, most_solved, microseconds[microseconds.size() / 2] / 1000, microseconds.back() / 1000);

  sinew::render::Options options;
  options.overlay = false;
  const sinew::convert::Error error = sinew::render::render_recording(recording, options, output, {});
  if (!error) return 0;
  std::fprintf(stderr, "crowd: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: crowd ASSET.sinew OUT [CHARACTERS] [SECONDS]\n");
    return 2;
  }
  const int count = argc > 3 ? std::atoi(argv[3]) : 200;
  const double seconds = argc > 4 ? std::atof(argv[4]) : 8;
  if (count < 1 || !(seconds >= 0)) {
    std::fprintf(stderr, "crowd: at least one character and no negative time\n");
    return 2;
  }
  return run(argv[1], argv[2], count, seconds);
} catch (const std::exception& error) {
  std::fprintf(stderr, "crowd: %s\n", error.what());
  return 1;
}
