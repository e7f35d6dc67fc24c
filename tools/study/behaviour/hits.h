// Hits on a body whose muscles have a tone: how far what is hit turns, when, and how it comes back; from
// recorded poses alone. Only the count of unknowns is the runtime's own.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sinew/muscle/tone.h"
#include "sinew/skeleton/skeleton.h"
#include "study/scenes/situation.h"

namespace sinew::study {

/// Where a body is hit: what turns, and the joint whose body is struck at its centre of mass; or, where
/// `at_joint` is one of its children's, there.
struct HitPlace {
  const char* name;
  Role role;
  Role at_joint = Role::kNone;
  double ahead = -1;  ///< direction of the hit; 1: from behind, as a knee gives way
};

struct Hit {
  const char* place = "";
  Tone tone = Tone::kAlert;
  double hz = 60, impulse = 0;  ///< N·s, in one step
  double peak = 0;              ///< rad that it turns from where the animation has it
  double peak_time = 0;         ///< s after the hit
  double back = 0;              ///< s after the hit, from which on it stays within 5°
  double overshoot = 0;         ///< beyond the animation, about the axis of the peak, as a share of that
  double first = 0;             ///< rad, in the frame of the hit
  int unknowns = 0;             ///< degrees of freedom that are solved for 1 s after the hit
  std::string refused;
};

struct HitPlan {
  std::vector<double> impulses{}, rates{};  ///< N·s, Hz; none: nobody is hit

  static HitPlan full() { return {{2, 5, 10, 20, 30, 40, 60, 80}, {30, 60, 120}}; }
  static HitPlan quick() { return {{5, 20, 40}, {60}}; }
};

/// The mannequin (which must be there) stands on a driven root and is hit. `progress(done, total)` may be
/// empty.
std::vector<Hit> run_hits(const HitPlan& plan, const std::function<void(int, int)>& progress);

/// One list of bounds for each tone ("hits_alert"), from what people's bodies do, and one for the rates
/// ("hits_rates"), where there are several. Bounds on single hits are those of 5 to 40 N·s.
struct HitScene {
  std::string name;
  Findings findings;
};
std::vector<HitScene> judge_hits(const std::vector<Hit>& hits);

/// [{"place", "tone", "hz", "impulse", "peak_deg", "peak_s", "back_s", "overshoot", "unknowns_after_1_s"}]
nlohmann::json hits_json(const std::vector<Hit>& hits);
std::string hits_table(const std::vector<Hit>& hits);

}  // namespace sinew::study
