// A crowd that walks; 5 % of it are hit every second, every third of these so hard that it goes limp and is
// left lying. Grey: played and checked in batches. Amber: some of its degrees of freedom are solved. Red: all
// of them. Usage: crowd ASSET.sinew OUT.mp4|OUT_%03d.png [CHARACTERS] [SECONDS] [THREADS]
#include <sinew/crowd/population.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>

#include "job_system.h"
#include "render/render.h"

namespace {

constexpr int kRate = 60;           // steps per second
constexpr double kSpacing = 2.2;    // m
constexpr double kHitShare = 0.05;  // of the crowd, per second

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

/// What the renderer shows of one character: its pose, and its level as the load that colours it.
sinew::scene::CharacterFrame frame_of(const sinew::Population& people, int n, int dofs) {
  sinew::scene::CharacterFrame frame;
  frame.model.assign(people.model(n).begin(), people.model(n).end());
  const sinew::Level level = people.level(n);
  frame.total_dofs = dofs;
  frame.unknown_dofs = level >= sinew::Level::kFull ? dofs : level == sinew::Level::kPartial ? dofs / 2 : 0;
  frame.load.assign(frame.model.size(), level >= sinew::Level::kFull      ? 1.f
                                        : level == sinew::Level::kPartial ? 0.75f
                                                                          : 0.f);
  frame.effort = frame.load;
  frame.torque.assign(frame.model.size(), 0);
  frame.limit.assign(frame.model.size(), 0);
  return frame;
}

/// Pushes somebody at the chest, from any side; every third one as if it had been knocked out.
void hit(sinew::Population& people, int count, int chest, int number, std::mt19937& random) {
  const int n = static_cast<int>(random() % static_cast<unsigned>(count));
  const float angle = static_cast<float>(random() % 628) / 100;
  const bool knocked_out = number % 3 == 2;
  const float impulse = knocked_out ? 150.f : 60.f;
  if (!people.push(n, chest, {impulse * std::cos(angle), impulse * std::sin(angle), 0})) return;
  if (!knocked_out) return;
  (void)people.solved(n).set_root_drive(sinew::RootDrive::kFree);
  (void)people.solved(n).set_strength(0.02f);
}

int run(const char* file, const char* output, int count, double seconds, int threads) {
  auto asset = std::make_shared<sinew::Asset>();
  const sinew::Status loaded = sinew::load_asset(file, *asset);
  if (!loaded || asset->clips.empty()) {
    std::fprintf(stderr, "crowd: %s: %s\n", file, loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const sinew::Clip& walk = asset->clips[static_cast<std::size_t>(std::max(0, asset->find_clip("walk")))];
  const int chest = std::max(0, asset->skeleton.find(sinew::Role::kChest));
  const std::vector<Walker> walkers = arranged(count, walk.duration);
  sinew::PopulationSettings settings;
  settings.crowd.capacity = count;
  settings.crowd.chunks = 4 * threads;
  settings.world.workers = threads;
  settings.world.detail.sleep_after = 0.5;  // s; who lies still costs nothing
  settings.places = std::min(count, 32 + count / 2);
  sinew::Status status;
  const auto people = sinew::Population::create(asset->skeleton, settings, status);
  for (int n = 0; people && n < count; ++n) {
    const Walker& w = walkers[static_cast<std::size_t>(n)];
    status = people->play(n, {&walk, w.phase, w.place});
    if (!status) break;
  }
  if (!status) {
    std::fprintf(stderr, "crowd: %s\n", status.reason);
    return 1;
  }
  JobSystem jobs(threads);
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
  std::vector<double> microseconds;
  std::mt19937 random(2);
  int hits = 0, most_solved = 0;
  const int steps = static_cast<int>(seconds * kRate);
  for (int step = 0; step <= steps; ++step) {
    for (const double due = (step / double(kRate) - 0.5) * kHitShare * count; hits < due; ++hits)
      hit(*people, count, chest, hits, random);
    const auto begin = std::chrono::steady_clock::now();
    if (!people->step(1.f / kRate, jobs.parallel_for())) return 1;
    microseconds.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    sinew::scene::Frame& frame = recording.frames.emplace_back();
    frame.time = step / double(kRate);
    int solved = 0;
    for (int n = 0; n < count; ++n) {
      frame.characters.push_back(frame_of(*people, n, asset->skeleton.dof_total()));
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
    std::fprintf(stderr, "usage: crowd ASSET.sinew OUT [CHARACTERS] [SECONDS] [THREADS]\n");
    return 2;
  }
  const int count = argc > 3 ? std::atoi(argv[3]) : 200;
  const double seconds = argc > 4 ? std::atof(argv[4]) : 8;
  const int threads = argc > 5 ? std::atoi(argv[5]) : 4;
  if (count < 1 || !(seconds >= 0) || threads < 1 || threads > 64) {
    std::fprintf(stderr, "crowd: at least one character, no negative time, 1 to 64 threads\n");
    return 2;
  }
  return run(argv[1], argv[2], count, seconds, threads);
} catch (const std::exception& error) {
  std::fprintf(stderr, "crowd: %s\n", error.what());
  return 1;
}
