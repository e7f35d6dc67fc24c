// Push maps: how hard a push has to be until a standing body steps, and until it falls, by direction; beside
// what people bear.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "scene/run.h"
#include "sinew/skeleton/skeleton.h"
#include "study/behaviour/aftermath.h"

namespace sinew::study {

constexpr double kPushed = 0.1;  ///< s, that a push lasts
constexpr double kWatched = 5;   ///< s, that the body is watched after it

/// Who stands or walks on the project's mannequin (which must be there), keeping its balance on a root that
/// has nothing but the ground; or led, for comparison.
scene::Scene balancing_scene(const char* clip, bool grounded, double seconds, double hz);

/// One push at `time` s: an impulse (N·s) in a direction about the vertical (rad; 0 ahead, positive left).
struct PushCase {
  const char* clip = "stand";
  Role where = Role::kChest;
  double direction = 0, impulse = 0, time = 1, hz = 60;
};

struct PushRun {
  Aftermath after;
  double off_clip = 0;              ///< m, in the last frame
  double help = 0, help_peak = 0;   ///< N·m·s and N·m of torque that the ground did not give
  int frames = 0, unconverged = 0;  ///< steps
  std::string refused;              ///< why it could not be run
};

/// `led`: off_clip() is measured against this run of the same clip, at least as long.
PushRun run_push(const PushCase& push, const scene::Recording& led);

/// N·s at which half of the people step, and fall whatever they do.
struct PushLimits {
  double stay_step = 0, step_fall = 0;
};

/// Of a body of so many kg: ahead, back and to the side as the linear inverted pendulum with human reactions
/// and steps gives them ("ankle" and "any number of steps": 25 and 101, 18 and 67, 21 and 60 N·s of 75 kg);
/// in between on the ellipse through the two neighbours, (cos/ahead)² + (sin/side)² = 1/limit².
PushLimits human_limits(double direction, double mass);

/// The impulse at which half of the runs do something, from how many of `seeds` did at each impulse: shares
/// are made monotone (pooled adjacent violators) and joined by straight lines from none at 0. NaN where they
/// do not come to half.
double half_point(const std::vector<double>& impulses, const std::vector<double>& did, int seeds);

struct PushDirection {
  std::string name;
  double angle = 0;                           ///< rad
  std::vector<std::array<int, 3>> runs;       ///< [impulse][outcome] so many seeds
  double stay_step_50 = 0, step_fall_50 = 0;  ///< N·s; NaN: not on the ladder
  PushLimits human;
  int milder = 0;   ///< impulses whose median outcome is milder than that of a smaller one
  double slip = 0;  ///< m, most of any run that did not fall
  double help_stay = 0, help_step = 0, help_peak = 0;  ///< N·m·s and N·m, likewise; step: up to two lifts
  double off_stay = 0, off_step = 0;                   ///< m off the clip in the end, likewise
  int frames = 0, unconverged = 0;
};

struct PushSweep {
  Role where = Role::kChest;
  double hz = 60;
  int directions = 8;              ///< 8, 4, or 2: ahead and left
  std::vector<double> impulses{};  ///< N·s, rising
  int seeds = 10;                  ///< that shift the push's time
};

struct PushMap {
  PushSweep sweep;
  double mass = 0;   ///< kg
  std::string name;  ///< "stand, chest, 60 Hz"
  std::vector<PushDirection> directions;
  std::string refused;
};

/// On all processors. A seed that fell from three impulses in a row is taken to fall from all harder ones.
/// `progress(done, total)` may be empty.
PushMap run_push_map(const PushSweep& sweep, const std::function<void(int, int)>& progress);

/// Maps beside the human limits, .png or .svg by the ending.
convert::Error draw_push_maps(const std::vector<PushMap>& maps, const std::string& file);

}  // namespace sinew::study
