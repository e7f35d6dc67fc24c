#include <algorithm>
#include <cstdio>

#include "study/study.h"

namespace sinew::study {
namespace {

std::string step_name(double h) {
  char text[32];
  std::snprintf(text, sizeof text, "1/%.0f", 1 / h);
  return text;
}

StabilityRow run_row(Run run, const Trial& trial, bool in_float) {
  const Verdict verdict = run(trial);
  StabilityRow row{trial.h, in_float, verdict.passed(), verdict.reason(), {}, 0, {}, verdict.measured()};
  row.excess = excess_of(row.measured);
  row.slowest = row.measured.slowest_over_median();
  row.notes = verdict.notes();
  return row;
}

std::string name_of(const StabilityRow& row) {
  return std::string(row.in_float ? "float " : "double ") + step_name(row.h) + ": ";
}

/// Its set-up, or what is wrong with the file.
convert::Error load(const HardCase& hard_case, Trial& trial) {
  const std::string file = scene_file(hard_case);
  return file.empty() ? convert::Error{} : scene::load_scene(file, trial.scene);
}

double per_step(double sum, const Measurement& m) {
  return m.steps ? sum / m.steps : 0;
}

}  // namespace

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> all;
  for (const auto& part : {rotation_cases(), mass_cases(), loop_cases(), contact_cases(), pile_cases(),
                           muscle_cases(), actuation_cases(), input_cases(), general_cases()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

StabilityResult run_case(const HardCase& hard_case, bool quick) {
  StabilityResult result;
  result.hard_case = hard_case;
  result.reason = hard_case.unsupported;
  Trial trial;
  trial.quick = quick;
  if (const convert::Error error = load(hard_case, trial)) {
    result.reason = error.message;
    return result;
  }
  for (const double h : hard_case.steps) {
    trial.h = h;
    if (hard_case.in_float) result.rows.push_back(run_row(hard_case.in_float, trial, true));
    if (hard_case.in_double) result.rows.push_back(run_row(hard_case.in_double, trial, false));
  }
  for (const StabilityRow& row : result.rows) {
    if (!row.passed && result.reason.empty()) result.reason = name_of(row) + row.reason;
    if (!row.excess.empty() && result.excess.empty()) result.excess = name_of(row) + row.excess;
  }
  result.passed = result.reason.empty();
  return result;
}

void judge_times(StabilityResult& result, bool quick, const MachineCheck& fresh) {
  constexpr double kMostMedians = 10;
  constexpr int kAgain = 2;
  Trial trial;
  trial.quick = quick;
  for (StabilityRow& row : result.rows) {
    if (row.slowest <= kMostMedians) continue;
    if (load(result.hard_case, trial)) return;
    trial.h = row.h;
    MachineCheck machine = fresh;
    machine.run();
    for (int n = 0; n < kAgain && row.slowest > kMostMedians && !machine.busy(); ++n) {
      const Run run = row.in_float ? result.hard_case.in_float : result.hard_case.in_double;
      row.slowest = std::min(row.slowest, run(trial).measured().slowest_over_median());
    }
    machine.run();
    if (row.slowest <= kMostMedians || !result.slow.empty()) continue;
    char text[100];
    std::snprintf(text, sizeof text, "the slowest step takes %.0f times the median, at most %.0f wanted",
                  row.slowest, kMostMedians);
    result.slow = name_of(row) + text;
    if (machine.busy()) result.slow += "; not judged, the machine was busy: " + machine.reason();
  }
}

std::vector<StabilityResult> run_stability(const StabilityOptions& options,
                                           const std::function<void(int, int)>& progress,
                                           const std::function<void(const StabilityResult&)>& finished) {
  std::vector<HardCase> cases = hard_cases();
  if (!options.only.empty()) std::erase_if(cases, [&](const HardCase& c) { return c.name != options.only; });
  std::vector<StabilityResult> results;
  const MachineCheck machine;
  for (const HardCase& c : cases) {
    results.push_back(run_case(c, options.quick));
    if (options.times) judge_times(results.back(), options.quick, machine);
    if (finished) finished(results.back());
    if (progress) progress(static_cast<int>(results.size()), static_cast<int>(cases.size()));
  }
  return results;
}

std::string stability_table_head() {
  return "case                          row    h       type    result  gain J    rise J    leap J    seen  "
         "gap m    "
         "deep mm  "
         "passes mean/p99/max  factors  unconverged  us/step  slowest/median\n";
}

std::string stability_table(const StabilityResult& result) {
  std::string text;
  char line[300];
  for (const StabilityRow& row : result.rows) {
    const Measurement& m = row.measured;
    std::snprintf(
        line, sizeof line,
        "%-29s %-6s %-7s %-7s %-7s %-9.2g %-9.2g %-9.2g %-5.2f %-8.1g %-8.3f %6.2f /%3d /%3d      %7.2f  "
        "%5d of %-7d %8.2f %6.1f\n",
        result.hard_case.name, result.hard_case.row, step_name(row.h).c_str(),
        row.in_float ? "float" : "double", row.passed ? "pass" : "FAIL", m.energy_gain, m.worst_rise, m.leap,
        m.seen_share(), m.joint_gap, 1e3 * m.penetration, m.mean_passes(), m.passes_percentile(0.99),
        m.most_passes, m.mean_factorisations(), m.unconverged, m.solved, per_step(m.microseconds, m),
        row.slowest);
    text += line;
  }
  if (result.rows.empty()) {
    std::snprintf(line, sizeof line, "%-29s %-6s %-7s %-7s FAIL\n", result.hard_case.name,
                  result.hard_case.row, "-", "-");
    text += line;
  }
  if (!result.passed) text += "    " + result.reason + "\n";
  for (const std::string& of_steps : {result.excess, result.slow})
    if (!of_steps.empty()) text += "    steps: " + of_steps + "\n";
  for (const StabilityRow& row : result.rows)
    for (const std::string& note : row.notes) text += "    note: " + note + "\n";
  return text;
}

std::string stability_csv(const std::vector<StabilityResult>& results) {
  std::string csv =
      "case,row,h_s,type,passed,reason,steps,energy_gain_J,worst_rise_J,leap_J,kinetic_most_J,joint_gap_m,"
      "penetration_m,"
      "passes_mean,passes_p99,passes_max,factorisations_mean,factorisations_max,unconverged,solved,us_per_"
      "step,slowest_over_median\n";
  char line[500];
  for (const StabilityResult& result : results) {
    if (result.rows.empty()) {
      csv += std::string(result.hard_case.name) + "," + result.hard_case.row + ",,,0,\"" + result.reason +
             "\",,,,,,,,,,,,,,,,\n";
      continue;
    }
    for (const StabilityRow& row : result.rows) {
      const Measurement& m = row.measured;
      std::snprintf(
          line, sizeof line,
          "%s,%s,%.9g,%s,%d,\"%s\",%d,%.6g,%.6g,%.6g,%.6g,%.3g,%.6g,%.3f,%d,%d,%.3f,%d,%d,%d,%.3f,%.2f\n",
          result.hard_case.name, result.hard_case.row, row.h, row.in_float ? "float" : "double", row.passed,
          row.reason.c_str(), m.steps, m.energy_gain, m.worst_rise, m.leap, m.kinetic_most, m.joint_gap,
          m.penetration, m.mean_passes(), m.passes_percentile(0.99), m.most_passes, m.mean_factorisations(),
          m.most_factorisations, m.unconverged, m.solved, per_step(m.microseconds, m), row.slowest);
      csv += line;
    }
  }
  return csv;
}

nlohmann::json stability_json(const std::vector<StabilityResult>& results) {
  nlohmann::json cases = nlohmann::json::array();
  int passed = 0, exceed = 0;
  for (const StabilityResult& result : results) {
    nlohmann::json trials = nlohmann::json::array();
    for (const StabilityRow& row : result.rows) {
      const Measurement& m = row.measured;
      trials.push_back({{"h", row.h},
                        {"type", row.in_float ? "float" : "double"},
                        {"passed", row.passed},
                        {"reason", row.reason},
                        {"energy_gain", m.energy_gain},
                        {"worst_rise", m.worst_rise},
                        {"leap", m.leap},
                        {"kinetic_most", m.kinetic_most},
                        {"energy_seen", m.seen_share()},
                        {"blind", m.blind},
                        {"joint_gap", m.joint_gap},
                        {"penetration", m.penetration},
                        {"passes_mean", m.mean_passes()},
                        {"passes_p99", m.passes_percentile(0.99)},
                        {"passes_max", m.most_passes},
                        {"factorisations_mean", m.mean_factorisations()},
                        {"unconverged", m.unconverged},
                        {"restarts", m.restarts},
                        {"solved", m.solved},
                        {"slowest_over_median", row.slowest},
                        {"notes", row.notes},
                        {"microseconds", per_step(m.microseconds, m)}});
    }
    cases.push_back({{"name", result.hard_case.name},
                     {"passed", result.passed},
                     {"reason", result.reason},
                     {"excess", result.excess},
                     {"slow", result.slow},
                     {"row", result.hard_case.row},
                     {"source", result.hard_case.source},
                     {"criterion", result.hard_case.criterion},
                     {"scene", scene_file(result.hard_case)},
                     {"trials", trials}});
    passed += result.passed;
    exceed += !result.excess.empty();
  }
  return {{"cases", cases}, {"passed", passed}, {"failed", int(results.size()) - passed}, {"exceed", exceed}};
}

}  // namespace sinew::study
