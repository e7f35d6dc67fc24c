// `sinew study behaviour`: push maps beside what people bear, and scenes with bounds, all judged from
// recorded poses. Only what poses cannot show (help, steps that were solved or did not converge) is the
// runtime's own count.
#pragma once

#include <nlohmann/json.hpp>

#include "study/behaviour/falls.h"
#include "study/behaviour/get_up_study.h"
#include "study/behaviour/hits.h"
#include "study/behaviour/push_map.h"
#include "study/scenes/situation.h"

namespace sinew::study {

struct BehaviourPlan {
  std::vector<PushSweep> sweeps;
  HitPlan hits;
  double undisturbed = 60;  ///< s
  int phases = 4;           ///< of a walk, in which it is pushed
  FallPlan falls;
  GetUpPlan get_ups;

  /// 8 directions, chest and pelvis, 10 seeds, chest also at 30 and 120 Hz.
  static BehaviourPlan full();
  /// 4 directions, chest, 3 seeds, 60 Hz, half of the impulses.
  static BehaviourPlan quick();
};

struct BehaviourScene {
  std::string name;
  Findings findings;
};

struct BehaviourResult {
  std::vector<PushMap> maps;
  std::vector<Hit> hits;
  std::vector<BehaviourScene> scenes;
  std::vector<FallRun> falls;
  std::vector<GetUpResult> get_ups;
};

/// `progress(done, total)` of the map that is being made; may be empty.
convert::Error run_behaviour(const BehaviourPlan& plan, const std::function<void(int, int)>& progress,
                             BehaviourResult& result);

/// Why a scene fails today, or nullptr. The one list.
const char* behaviour_known_to_fail(const std::string& scene);

/// {"push_map": [{"scene", "direction", "stay_step_50", "step_fall_50", "human_stay_step",
/// "human_step_fall"}], "hits": see hits_json, "falls": see falls_json, "scenes": [{"name", "passed",
/// "criteria": [{"name", "value", "bound", "passed"}]}]}; N·s, null where the ladder of impulses does not
/// reach.
nlohmann::json behaviour_json(const BehaviourResult& result);
std::string behaviour_table(const BehaviourResult& result);

}  // namespace sinew::study
