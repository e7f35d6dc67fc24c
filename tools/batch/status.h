// How far a plan is: computed from its results alone.
#pragma once

#include "batch/plan.h"

namespace sinew::batch {

struct Status {
  std::size_t done = 0, failed = 0, left = 0;
  std::vector<int> open;   ///< shards with units that have no result
  double seconds = 0;      ///< that the results took, each on its own process
  nlohmann::json by_kind;  ///< {"convert": {"done", "failed", "left", "seconds", "estimated_seconds"}};
                           ///< seconds of what is done
  std::vector<std::pair<std::string, std::string>> failures;  ///< name, why; in the plan's order
};

convert::Error read_status(const Plan& plan, Status& out);

}  // namespace sinew::batch
