#include "study/accuracy_crowds.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "scene/play.h"
#include "sinew/crowd/population.h"
#include "study/accuracy_clock.h"
#include "study/mannequin.h"
#include "study/scenes/situation.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;  // s

/// µs of processor time.
template <class Work>
double timed(const Work& work) {
  const double begin = processor_seconds();
  work();
  return 1e6 * std::max(0.0, processor_seconds() - begin - clock_cost());
}

/// How many are solved for in the last step.
template <class T>
int solved_in(World<T>& world) {
  int solved = 0;
  for (int c = 0; c < world.character_count(); ++c) solved += world.character(c).report().unknown_dofs > 0;
  return solved;
}

template <class T>
convert::Error play_once(const scene::Scene& scene, std::vector<double>& frames, double& solved) {
  World<T> world(scene.world);
  scene::Play<T> play(scene, world);
  if (convert::Error error = play.set_up()) return error;
  const int count = static_cast<int>(std::lround(scene.duration / kFrame));
  for (int f = 0; f < count; ++f) {
    if (convert::Error error = play.prepare(f * kFrame, (f + 1) * kFrame)) return error;
    for (const scene::Impulse& p : play.pushes(f * kFrame, (f + 1) * kFrame))
      if (const Status status = scene::apply(p, T(kFrame), world); !status) return {status.reason};
    Status status;
    frames.push_back(timed([&] { status = world.step(T(kFrame)); }));
    if (!status) return {scene.title + ": " + status.reason};
    solved += double(solved_in(world)) / count;
  }
  return {};
}

constexpr double kSpacing = 2.2;   // m, between walkers
constexpr double kSettling = 0.5;  // s
constexpr int kPushFrames = 6;     // as long as in the scene "tracking"
constexpr float kPush = 60;        // N·s

std::unique_ptr<Population> walkers(const Asset& asset, int count, Status& status) {
  PopulationSettings settings;
  settings.crowd.capacity = count;
  settings.places = std::min(count, 32 + count / 2);
  auto people = Population::create(asset.skeleton, settings, status);
  const Clip& walk = asset.clips[std::max(0, asset.find_clip("walk"))];
  std::mt19937 random(1);
  std::uniform_real_distribution<double> phase(0, walk.duration);
  const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
  for (int n = 0; people && n < count; ++n) {
    Transform<float> place;
    const std::div_t at = std::div(n, columns);
    place.translation = Vec3<double>(-kSpacing * at.quot, kSpacing * at.rem, 0).cast<float>();
    status = people->play(n, {&walk, phase(random), place});
    if (!status) return nullptr;
  }
  return people;
}

convert::Error walk_once(const Asset& asset, int count, double percent_hit, double seconds,
                         std::vector<double>& frames, double& solved) {
  Status status;
  const std::unique_ptr<Population> people = walkers(asset, count, status);
  if (!people) return {status.reason};
  const int chest = std::max(0, asset.skeleton.find(Role::kChest)),
            settling = static_cast<int>(std::lround(kSettling / kFrame)),
            steps = settling + static_cast<int>(std::lround(seconds / kFrame));
  std::mt19937 random(2);
  std::uniform_real_distribution<float> angle(0, 6.2831853f);
  struct Pushed {
    int character, until;
    Vec3<float> impulse;  // N·s in every frame
  };
  std::vector<Pushed> pushed;
  double due = 0;
  for (int step = 0; step < steps; ++step) {
    for (due += percent_hit / 100 * count * kFrame; due >= 1; due -= 1) {
      const float from = angle(random), each = kPush / kPushFrames;
      pushed.push_back({static_cast<int>(random() % static_cast<unsigned>(count)),
                        step + kPushFrames,
                        {each * std::cos(from), each * std::sin(from), 0}});
    }
    std::erase_if(pushed, [&](const Pushed& p) { return step >= p.until; });
    for (const Pushed& p : pushed) (void)people->push(p.character, chest, p.impulse);
    const double us = timed([&] { status = people->step(float(kFrame)); });
    if (!status) return {status.reason};
    if (step < settling) continue;
    frames.push_back(us);
    solved += double(people->solved_count()) / (steps - settling);
  }
  return {};
}

}  // namespace

convert::Error measure_situation(const std::string& name, double seconds, int runs, CrowdCost& out) {
  const std::vector<Situation> all = situations();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Situation& s) { return name == s.name; });
  if (found == all.end()) return {"there is no situation '" + name + "'"};
  scene::Scene scene;
  if (convert::Error error = scene::load_scene(situation_file(*found), scene)) return error;
  scene.duration = std::min(scene.duration, seconds);
  out.name = name;
  out.title = scene.title;
  out.characters = static_cast<int>(scene.characters.size());
  std::vector<std::vector<double>> times(runs);
  for (std::vector<double>& run : times) {
    out.solved = 0;
    const convert::Error error = scene.double_precision ? play_once<double>(scene, run, out.solved)
                                                        : play_once<float>(scene, run, out.solved);
    if (error) return error;
  }
  out.us = frame_costs(times);
  return {};
}

convert::Error measure_walkers(int count, double percent_hit, double seconds, int runs, CrowdCost& out) {
  const Asset* asset = mannequin();
  if (!asset || asset->clips.empty()) return {"the mannequin is missing"};
  out.characters = count;
  std::vector<std::vector<double>> times(runs);
  for (std::vector<double>& run : times) {
    out.solved = 0;
    if (convert::Error error = walk_once(*asset, count, percent_hit, seconds, run, out.solved)) return error;
  }
  out.us = frame_costs(times);
  return {};
}

std::vector<CrowdCost> measure_crowds(bool quick, const std::function<void(int, int)>& progress) {
  constexpr int kWalkers = 1000;
  const int runs = quick ? 3 : 7;
  const double seconds = quick ? 2 : 5;
  std::vector<CrowdCost> all;
  int done = 0;
  const auto add = [&](const char* name, const char* title, const auto& measure) {
    CrowdCost cost;
    const bool measured = !measure(cost);
    cost.name = name, cost.title = title;
    if (measured) all.push_back(cost);
    if (progress) progress(++done, 5);
  };
  add("walkers", "1000 walkers, nobody is touched",
      [&](CrowdCost& c) { return measure_walkers(kWalkers, 0, seconds, runs, c); });
  add("walkers_hit", "1000 walkers, 50 of them are pushed in every second",
      [&](CrowdCost& c) { return measure_walkers(kWalkers, 5, seconds, runs, c); });
  add("pile", "Ten limp figures fall on a heap",
      [&](CrowdCost& c) { return measure_situation("pile", seconds, runs, c); });
  add("crowd_pushed", "Twenty who stand close are all hit at once",
      [&](CrowdCost& c) { return measure_situation("crowd_pushed", seconds, runs, c); });
  add("corner", "Ten limp figures are thrown into a corner",
      [&](CrowdCost& c) { return measure_situation("corner", seconds, runs, c); });
  return all;
}

}  // namespace sinew::study
