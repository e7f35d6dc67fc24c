// Studies: evidence that the runtime does what it promises, as tables, CSV, JSON and pictures.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/accuracy_clock.h"
#include "study/hard_case.h"

namespace sinew::study {

struct StabilityOptions {
  bool quick = false;
  std::string only;   ///< name of one case; empty: all
  bool times = true;  ///< judge the times of steps, where the machine is found quiet
};

/// One case at one step and precision.
struct StabilityRow {
  double h = 0;  ///< s
  bool in_float = false;
  bool passed = false;
  std::string reason;  ///< of the failure
  std::string excess;  ///< of its steps' passes, in words: see excess_of
  double slowest = 0;  ///< step over the median step
  std::vector<std::string> notes;
  Measurement measured;
};

struct StabilityResult {
  HardCase hard_case;
  std::vector<StabilityRow> rows;
  bool passed = false;  ///< in every row, and supported
  std::string reason;   ///< of the first failure
  std::string excess;   ///< of its steps, the first: passes
  std::string slow;     ///< the same, time: more than ten medians, or why that is not judged
};

/// Runs one case at all its steps in float and double.
StabilityResult run_case(const HardCase& hard_case, bool quick);

/// Looks at the times of a case's steps: on a quiet machine rows whose slowest step took more than ten
/// medians are run again, twice, for what a machine does beside it is not the same every time. Fills
/// result.slow.
void judge_times(StabilityResult& result, bool quick, const MachineCheck& fresh);

/// Runs the catalogue; `progress(done, total)` and `finished(result)` may be empty. An unknown name in `only`
/// gives no results.
std::vector<StabilityResult> run_stability(const StabilityOptions& options,
                                           const std::function<void(int, int)>& progress,
                                           const std::function<void(const StabilityResult&)>& finished);

/// Head and rows of the table for a terminal.
std::string stability_table_head();
std::string stability_table(const StabilityResult& result);
std::string stability_csv(const std::vector<StabilityResult>& results);
/// {"cases": [{"name", "passed", "reason", "excess", "slow", "row", "source", "criterion", "trials": […]}],
/// "passed", "failed", "exceed"}
nlohmann::json stability_json(const std::vector<StabilityResult>& results);

}  // namespace sinew::study
