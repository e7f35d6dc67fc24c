#include "study/behaviour/push_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>

#include "study/mannequin.h"
#include "study/on_all_processors.h"

namespace sinew::study {
namespace {

constexpr double kHumanMass = 75;                                    ///< kg, of the limits below
constexpr PushLimits kAhead{25, 101}, kBack{18, 67}, kSide{21, 60};  ///< N·s
constexpr double kFirstPush = 1, kSeedShift = 0.117;  ///< s: seeds also differ in where steps cut the push
constexpr int kSurelyFalls = 3;                       ///< impulses in a row

double on_ellipse(double ahead, double side, double angle) {
  return 1 / std::hypot(std::cos(angle) / ahead, std::sin(angle) / side);
}

/// The smallest impulse at which the joined shares reach a half, from shares that never fall.
double crossing(const std::vector<double>& impulses, const std::vector<double>& shares) {
  double x = 0, share = 0;
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    if (shares[i] >= 0.5) return x + (impulses[i] - x) * (0.5 - share) / (shares[i] - share);
    x = impulses[i];
    share = shares[i];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

int median_outcome(const std::array<int, 3>& runs) {
  const int all = runs[0] + runs[1] + runs[2];
  if (2 * runs[2] > all) return 2;
  return 2 * (runs[1] + runs[2]) > all ? 1 : 0;
}

const char* name_of(double angle) {
  static constexpr const char* kNames[] = {"forward",  "forward left",   "left",  "backward left",
                                           "backward", "backward right", "right", "forward right"};
  return kNames[static_cast<std::size_t>(std::lround(angle / (std::numbers::pi / 4))) % 8];
}

void count(const PushRun& run, std::size_t impulse, PushDirection& into) {
  into.runs[impulse][static_cast<std::size_t>(run.after.outcome)] += 1;
  into.frames += run.frames;
  into.unconverged += run.unconverged;
  if (run.after.outcome == Outcome::kFall) return;
  const auto most = [](double& so_far, double value) { so_far = std::max(so_far, value); };
  const bool stays = run.after.outcome == Outcome::kStay;
  most(into.slip, run.after.slip);
  most(into.help_peak, run.help_peak);
  most(stays ? into.off_stay : into.off_step, run.off_clip);
  if (run.after.lifts <= 2) most(stays ? into.help_stay : into.help_step, run.help);  // one step, and back
}

void conclude(const PushSweep& sweep, PushDirection& d) {
  std::vector<double> moved, fell;
  int worst = 0;
  for (const std::array<int, 3>& runs : d.runs) {
    moved.push_back(runs[1] + runs[2]);
    fell.push_back(runs[2]);
    d.milder += median_outcome(runs) < worst;
    worst = std::max(worst, median_outcome(runs));
  }
  d.stay_step_50 = half_point(sweep.impulses, moved, sweep.seeds);
  d.step_fall_50 = half_point(sweep.impulses, fell, sweep.seeds);
}

PushMap empty_map(const PushSweep& sweep) {
  PushMap map{sweep, mannequin()->skeleton.total_mass(), "stand, ", {}, {}};
  map.name += sweep.where == Role::kChest ? "chest" : "pelvis";
  map.name += ", " + std::to_string(std::lround(sweep.hz)) + " Hz";
  for (int n = 0; n < sweep.directions; ++n) {
    PushDirection& d = map.directions.emplace_back();
    d.angle = 2 * std::numbers::pi * n / std::max(sweep.directions, 4);
    d.name = name_of(d.angle);
    d.human = human_limits(d.angle, map.mass);
    d.runs.resize(sweep.impulses.size());
  }
  return map;
}

/// All impulses of one seed in one direction.
void run_ladder(const PushSweep& sweep, int seed, const scene::Recording& led, PushDirection& into,
                std::mutex& writing, std::string& refused) {
  int falls = 0;
  for (std::size_t i = 0; i < sweep.impulses.size(); ++i) {
    PushRun run;
    run.after.outcome = Outcome::kFall;
    if (falls < kSurelyFalls)
      run = run_push(
          {"stand", sweep.where, into.angle, sweep.impulses[i], kFirstPush + seed * kSeedShift, sweep.hz},
          led);
    falls = run.after.outcome == Outcome::kFall ? falls + 1 : 0;
    const std::lock_guard lock(writing);
    if (!run.refused.empty()) refused = run.refused;
    count(run, i, into);
  }
}

}  // namespace

scene::Scene balancing_scene(const char* clip, bool grounded, double seconds, double hz) {
  scene::Scene s;
  const std::shared_ptr<const Asset> asset(std::shared_ptr<void>(), mannequin());  // lives as long as we do
  s.title = clip;
  s.duration = seconds;
  s.frame_rate = hz;
  scene::SceneCharacter c;
  c.asset = asset;
  c.name = "mannequin";
  c.clips.push_back({.clip = asset->find_clip(clip)});
  if (grounded) {
    c.root = {{0, RootDrive::kGrounded}};
    c.behaviour.emplace().get_up = GetUpPolicy::kNever;
  }
  s.characters.push_back(c);
  return s;
}

PushRun run_push(const PushCase& push, const scene::Recording& led) {
  PushRun run;
  scene::Scene s = balancing_scene(push.clip, true, push.time + kPushed + kWatched, push.hz);
  scene::Push p;
  p.time = push.time;
  p.duration = kPushed;
  p.joint = s.characters[0].asset->skeleton.find(push.where);
  p.impulse = push.impulse * Vec3<double>(std::cos(push.direction), std::sin(push.direction), 0);
  s.pushes.push_back(p);
  scene::Recording recording;
  scene::Telemetry telemetry;
  if (const convert::Error error = scene::run_scene(s, recording, telemetry, nullptr)) {
    run.refused = error.message;
    return run;
  }
  run.after = aftermath(recording);
  run.off_clip = off_motion(recording, led, static_cast<int>(recording.frames.size()) - 1);
  for (const scene::TelemetryRow& row : telemetry.rows) {
    ++run.frames;
    run.unconverged += !row.report.converged;
    run.help += row.report.help_torque / push.hz;
    run.help_peak = std::max(run.help_peak, row.report.help_torque);
  }
  return run;
}

PushLimits human_limits(double direction, double mass) {
  const PushLimits& along = std::cos(direction) >= 0 ? kAhead : kBack;
  const double scale = mass / kHumanMass;
  return {scale * on_ellipse(along.stay_step, kSide.stay_step, direction),
          scale * on_ellipse(along.step_fall, kSide.step_fall, direction)};
}

double half_point(const std::vector<double>& impulses, const std::vector<double>& did, int seeds) {
  struct Block {
    double sum, count;
  };
  std::vector<Block> blocks;
  for (const double n : did) {
    blocks.push_back({n / seeds, 1});
    while (blocks.size() > 1) {
      const Block last = blocks.back();
      Block& before = blocks[blocks.size() - 2];
      if (before.sum / before.count <= last.sum / last.count) break;
      before = {before.sum + last.sum, before.count + last.count};
      blocks.pop_back();
    }
  }
  std::vector<double> shares;
  for (const Block& block : blocks)
    shares.insert(shares.end(), static_cast<std::size_t>(block.count), block.sum / block.count);
  return crossing(impulses, shares);
}

PushMap run_push_map(const PushSweep& sweep, const std::function<void(int, int)>& progress) {
  PushMap map = empty_map(sweep);
  scene::Recording led;
  scene::Telemetry telemetry;
  const double longest = kFirstPush + kSeedShift * sweep.seeds + kPushed + kWatched;
  if (const convert::Error error =
          scene::run_scene(balancing_scene("stand", false, longest, sweep.hz), led, telemetry, nullptr)) {
    map.refused = error.message;
    return map;
  }
  std::mutex writing;
  const int jobs = static_cast<int>(map.directions.size()) * sweep.seeds;
  int done = 0;
  on_all_processors(jobs, [&](int n) {
    run_ladder(sweep, n % sweep.seeds, led, map.directions[static_cast<std::size_t>(n / sweep.seeds)],
               writing, map.refused);
    const std::lock_guard lock(writing);
    if (progress) progress(++done, jobs);
  });
  for (PushDirection& d : map.directions) conclude(sweep, d);
  return map;
}

}  // namespace sinew::study
