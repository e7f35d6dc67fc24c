// Studies: evidence that the runtime does what it promises, as tables, CSV, JSON and pictures.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/hard_case.h"

namespace sinew::study {

struct StabilityOptions {
  bool quick = false;
  std::string only;  ///< name of one case; empty: all
};

/// One case at one step and precision.
struct StabilityRow {
  double h = 0;  ///< s
  bool in_float = false;
  bool passed = false;
  std::string reason;  ///< of the failure
  Measurement measured;
};

struct StabilityResult {
  HardCase hard_case;
  std::vector<StabilityRow> rows;
  bool passed = false;  ///< in every row, and supported
  std::string reason;   ///< of the first failure
};

/// Runs one case at all its steps in float and double.
StabilityResult run_case(const HardCase& hard_case, bool quick);

/// Runs the catalogue; `progress(done, total)` and `finished(result)` may be empty. An unknown name in `only`
/// gives no results.
std::vector<StabilityResult> run_stability(const StabilityOptions& options,
                                           const std::function<void(int, int)>& progress,
                                           const std::function<void(const StabilityResult&)>& finished);

/// Head and rows of the table for a terminal.
std::string stability_table_head();
std::string stability_table(const StabilityResult& result);
std::string stability_csv(const std::vector<StabilityResult>& results);
/// {"cases": [{"name", "passed", "reason", "row", "source", "criterion", "trials": […]}], "passed", "failed"}
nlohmann::json stability_json(const std::vector<StabilityResult>& results);

}  // namespace sinew::study
