// Who falls and gets up: random falls, on the flat and on a slope, and pushes while it rises; judged from
// recorded poses, with help as the runtime counts it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/run.h"
#include "study/scenes/situation.h"

namespace sinew::study {

/// What a recording's first character did after it fell: nothing that a behaviour says of itself is read.
struct Rising {
  bool fell = false;       ///< anything but its feet touched the ground
  bool stands = false;     ///< in the end, for at least a second
  double decided = -1;     ///< s: it had lain still for a quarter of a second, and moves
  double stood = -1;       ///< s: from here on it stands
  double joint_speed = 0;  ///< rad/s, fastest of a joint between the two
  double slip = 0;   ///< m, furthest of a hand or foot that touches, over a quarter of a second or longer
  double depth = 0;  ///< m, deepest in the ground
  int decided_frame = -1, stood_frame = -1;
};

/// Stands: root above 0.9 of its height in the first frame, and only feet touch the ground. On a slope of
/// `slope` rad (rising ahead, through the origin) instead of the floor.
Rising rising(const scene::Recording& recording, double slope = 0);

struct GetUpResult {
  std::string name;  ///< "flat", "slope_10_deg", "interrupted"
  int falls = 0, stand = 0;
  std::vector<double> times;                    ///< s from decision to standing, of those that stand, sorted
  double help_force = 0, help_torque = 0;       ///< N, N·m: peaks from the decision on
  double slip = 0, joint_speed = 0, depth = 0;  ///< worst
  std::string refused;

  double median() const { return times.empty() ? 0 : times[times.size() / 2]; }
  double worst() const { return times.empty() ? 0 : times.back(); }
};

struct GetUpPlan {
  int falls = 200;         ///< on the flat, and as many on the slope
  int interruptions = 10;  ///< pushes of 60 N·s, at so many times of one rising

  static GetUpPlan quick() { return {12, 4}; }
};

std::vector<GetUpResult> run_get_ups(const GetUpPlan& plan, const std::function<void(int, int)>& progress);
void judge_get_ups(const GetUpResult& result, Findings& findings);
nlohmann::json get_ups_json(const std::vector<GetUpResult>& results);
std::string get_ups_table(const std::vector<GetUpResult>& results);

}  // namespace sinew::study
