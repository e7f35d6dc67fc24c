#include "study/behaviour/behaviour_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "study/mannequin.h"

namespace sinew::study {
namespace {

constexpr double kOffHuman = 0.2, kOffRates = 0.1;  ///< of the 50 % points
constexpr double kMostSlip = 0.010, kBack = 0.010;  ///< m
constexpr double kMostHelp = 8;                     ///< N·m, what a grounded root has unless it is asked
constexpr double kMostUnconverged = 1e-3;           ///< of all steps
constexpr double kWalkPush = 20;                    ///< N·s
constexpr double kStride = 1.1;                     ///< s, in which a walk's pushes are spread

/// The scene that a map's bounds are listed under.
std::string scene_of(const PushMap& map) {
  std::string name = "push " + map.name;
  std::erase(name, ',');
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// N·s; where half never did, the hardest push.
double at_least(double found, const PushSweep& sweep) {
  return std::isnan(found) ? sweep.impulses.back() : found;
}

void judge_limit(const char* what, const PushMap& map, const PushDirection& d, double found, double human,
                 Findings& findings) {
  const std::string name = std::string(what) + " off the human one, " + d.name + " (share)";
  findings.at_most(name.c_str(), std::abs(at_least(found, map.sweep) / human - 1), kOffHuman);
}

void judge_map(const PushMap& map, Findings& findings) {
  if (!map.refused.empty()) return findings.refuse(map.refused);
  int frames = 0, unconverged = 0;
  for (const PushDirection& d : map.directions) {
    judge_limit("stay/step", map, d, d.stay_step_50, d.human.stay_step, findings);
    judge_limit("step/fall", map, d, d.step_fall_50, d.human.step_fall, findings);
    frames += d.frames;
    unconverged += d.unconverged;
  }
  for (const PushDirection& d : map.directions) {
    findings.at_most("harder pushes that end milder (impulses)", d.milder, 0);
    findings.at_most("slip of a foot that stands (m)", d.slip, kMostSlip);
    findings.at_most("off the clip 5 s after a push without a step (m)", d.off_stay, kBack);
    findings.at_most("off the clip 5 s after a push with steps (m)", d.off_step, kBack);
    findings.at_most("help without a step (N m s)", d.help_stay, 0);
    findings.at_most("help with one step and back (N m s)", d.help_step, 0);
    findings.at_most("help, peak (N m)", d.help_peak, kMostHelp);
  }
  findings.at_most("steps that did not converge (share)", frames > 0 ? double(unconverged) / frames : 1,
                   kMostUnconverged);
}

/// Grounded and led, nothing happens: the same bits, and nothing to solve.
void judge_undisturbed(const char* clip, double seconds, Findings& findings) {
  const Played grounded(balancing_scene(clip, true, seconds, 60)),
      led(balancing_scene(clip, false, seconds, 60));
  for (const Played* played : {&grounded, &led})
    if (!played->refused.empty()) return findings.refuse(played->refused);
  double furthest = 0;
  int solved = 0;
  for (std::size_t f = 0; f < grounded.recording.frames.size(); ++f)
    furthest = std::max(furthest, apart(grounded.recording, 0, led.recording, 0, static_cast<int>(f)));
  for (const scene::TelemetryRow& row : grounded.telemetry.rows) solved += row.report.unknown_dofs > 0;
  findings.at_most("frames that were solved", solved, 0);
  findings.at_most("furthest from the driven run (m)", furthest, 0);
  findings.at_most("falls", aftermath(grounded.recording).outcome == Outcome::kFall ? 1 : 0, 0);
}

void judge_walk(int phases, Findings& findings) {
  Played led(balancing_scene("walk", false, 1 + kStride + kPushed + kWatched + 0.1, 60));
  if (!led.refused.empty()) return findings.refuse(led.refused);
  int falls = 0;
  for (int phase = 0; phase < phases; ++phase)
    for (const double side : {0.5, -0.5}) {
      const PushRun run = run_push(
          {"walk", Role::kChest, side * std::numbers::pi, kWalkPush, 1 + kStride * phase / phases, 60},
          led.recording);
      if (!run.refused.empty()) return findings.refuse(run.refused);
      const bool fell = run.after.outcome == Outcome::kFall;
      falls += fell;
      if (!fell) findings.at_most("off the clip 5 s later (m)", run.off_clip, kBack);
    }
  findings.at_most("falls", falls, 0);
}

/// The sweeps of one place at several rates: widest span of a 50 % point over its smallest value.
void judge_rates(const std::vector<PushMap>& maps, Findings& findings) {
  const PushMap& first = maps.front();
  for (std::size_t n = 0; n < first.directions.size(); ++n)
    for (const auto point : {&PushDirection::stay_step_50, &PushDirection::step_fall_50}) {
      double least = 1e9, most = 0;
      for (const PushMap& map : maps) {
        if (map.sweep.where != first.sweep.where) continue;
        const double found = at_least(map.directions[n].*point, map.sweep);
        least = std::min(least, found);
        most = std::max(most, found);
      }
      const std::string name =
          std::string(point == &PushDirection::stay_step_50 ? "stay/step" : "step/fall") + " apart, " +
          first.directions[n].name + " (share)";
      findings.at_most(name.c_str(), most / least - 1, kOffRates);
    }
}

bool several_rates(const std::vector<PushMap>& maps) {
  return std::any_of(maps.begin(), maps.end(), [&](const PushMap& map) {
    return map.sweep.where == maps.front().sweep.where && map.sweep.hz != maps.front().sweep.hz;
  });
}

std::string newtons(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", value);
  return text;
}

std::string map_table(const PushMap& map) {
  char line[300];
  std::string text = map.name + ": half of the pushes make it step, or fall (N·s; people in brackets)\n";
  text += "    direction        steps from     falls from     slip    help N m s  peak N m\n";
  for (const PushDirection& d : map.directions) {
    std::snprintf(line, sizeof line, "    %-15s %4s (%3s)     %4s (%3s)   %6.0f mm %9.1f %9.0f\n",
                  d.name.c_str(), newtons(d.stay_step_50).c_str(), newtons(d.human.stay_step).c_str(),
                  newtons(d.step_fall_50).c_str(), newtons(d.human.step_fall).c_str(), 1000 * d.slip,
                  std::max(d.help_stay, d.help_step), d.help_peak);
    text += line;
  }
  return text;
}

std::string scene_table(const BehaviourScene& scene) {
  char line[300];
  const char* known = behaviour_known_to_fail(scene.name);
  const bool passed = scene.findings.passed();
  std::string text = scene.name + (passed ? ": pass\n" : known ? ": known to fail\n" : ": FAIL\n");
  if (!scene.findings.refused().empty()) text += "    " + scene.findings.refused() + "\n";
  for (const Criterion& c : scene.findings.criteria()) {
    std::snprintf(line, sizeof line, "    %-4s %-54s %10.4g   bound %.4g\n", c.passed ? "" : "FAIL",
                  c.name.c_str(), c.value, c.bound);
    text += line;
  }
  if (!passed && known) text += std::string("    ") + known + "\n";
  return text;
}

}  // namespace

BehaviourPlan BehaviourPlan::quick() {
  BehaviourPlan plan;
  plan.sweeps = {{Role::kChest, 60, 4, {10, 20, 30, 40, 50, 60, 80, 100, 120}, 3}};
  plan.hits = HitPlan::quick();
  plan.falls = FallPlan::quick();
  plan.get_ups = GetUpPlan::quick();
  return plan;
}

BehaviourPlan BehaviourPlan::full() {
  BehaviourPlan plan;
  const std::vector<double> ladder{5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 70, 80, 90, 100, 110, 120};
  for (const auto& [where, hz] :
       {std::pair{Role::kChest, 60.0}, {Role::kPelvis, 60}, {Role::kChest, 30}, {Role::kChest, 120}})
    plan.sweeps.push_back({where, hz, 8, ladder, 10});
  plan.hits = HitPlan::full();
  plan.falls = FallPlan::full();
  return plan;
}

convert::Error run_behaviour(const BehaviourPlan& plan, const std::function<void(int, int)>& progress,
                             BehaviourResult& result) {
  if (!mannequin()) return {"the mannequin is missing"};
  for (const char* clip : {"stand", "walk"}) {
    BehaviourScene& scene = result.scenes.emplace_back();
    scene.name = std::string(clip) + "_" + std::to_string(std::lround(plan.undisturbed)) + "_s";
    judge_undisturbed(clip, plan.undisturbed, scene.findings);
  }
  for (const PushSweep& sweep : plan.sweeps) {
    result.maps.push_back(run_push_map(sweep, progress));
    result.scenes.push_back({scene_of(result.maps.back()), {}});
    judge_map(result.maps.back(), result.scenes.back().findings);
  }
  result.hits = run_hits(plan.hits, progress);
  for (HitScene& hits : judge_hits(result.hits)) result.scenes.push_back({hits.name, hits.findings});
  result.scenes.push_back({"push_while_walking", {}});
  judge_walk(plan.phases, result.scenes.back().findings);
  result.falls = run_falls(plan.falls, progress);
  for (const double hz : plan.falls.rates) {
    result.scenes.push_back({"falls_" + std::to_string(std::lround(hz)) + "_Hz", {}});
    judge_falls(result.falls, hz, result.scenes.back().findings);
  }
  result.get_ups = run_get_ups(plan.get_ups, progress);
  for (const GetUpResult& get_up : result.get_ups) {
    result.scenes.push_back({"get_up_" + get_up.name, {}});
    judge_get_ups(get_up, result.scenes.back().findings);
  }
  if (several_rates(result.maps)) {
    result.scenes.push_back({"rates", {}});
    judge_rates(result.maps, result.scenes.back().findings);
  }
  return {};
}

nlohmann::json behaviour_json(const BehaviourResult& result) {
  nlohmann::json maps = nlohmann::json::array(), scenes = maps;
  for (const PushMap& map : result.maps)
    for (const PushDirection& d : map.directions)
      maps.push_back({{"scene", map.name},
                      {"direction", d.name},
                      {"stay_step_50", d.stay_step_50},
                      {"step_fall_50", d.step_fall_50},
                      {"human_stay_step", d.human.stay_step},
                      {"human_step_fall", d.human.step_fall}});
  for (const BehaviourScene& scene : result.scenes) {
    nlohmann::json criteria = nlohmann::json::array();
    for (const Criterion& c : scene.findings.criteria())
      criteria.push_back({{"name", c.name}, {"value", c.value}, {"bound", c.bound}, {"passed", c.passed}});
    scenes.push_back({{"name", scene.name}, {"passed", scene.findings.passed()}, {"criteria", criteria}});
  }
  return {{"push_map", maps},
          {"hits", hits_json(result.hits)},
          {"falls", falls_json(result.falls)},
          {"scenes", scenes},
          {"get_ups", get_ups_json(result.get_ups)}};
}

std::string behaviour_table(const BehaviourResult& result) {
  std::string text;
  for (const PushMap& map : result.maps) text += map_table(map) + "\n";
  text += hits_table(result.hits);
  text += falls_table(result.falls);
  text += get_ups_table(result.get_ups);
  for (const BehaviourScene& scene : result.scenes) text += scene_table(scene);
  return text;
}

}  // namespace sinew::study
