#include "batch/status.h"

#include "batch/results.h"

namespace sinew::batch {

convert::Error read_status(const Plan& plan, Status& out) {
  out = {};
  out.by_kind = nlohmann::json::object();
  for (int shard = 1; shard <= plan.shards; ++shard) {
    std::vector<Unit> units;
    if (convert::Error error = read_shard(plan, shard, units)) return error;
    const std::size_t left = out.left;
    for (const Unit& unit : units) {
      const Result result = find_result(plan, unit, false);
      nlohmann::json& kind = out.by_kind[unit.kind];
      if (kind.is_null())
        kind = {{"done", 0}, {"failed", 0}, {"left", 0}, {"seconds", 0.0}, {"estimated_seconds", 0.0}};
      const char* state = result.state == "done" ? "done" : result.state == "failed" ? "failed" : "left";
      kind[state] = kind[state].get<int>() + 1;
      ++(result.state == "done" ? out.done : result.state == "failed" ? out.failed : out.left);
      if (result.state == "failed") out.failures.emplace_back(unit.name, result.error);
      if (result.state != "done") continue;
      out.seconds += result.seconds;
      kind["seconds"] = kind["seconds"].get<double>() + result.seconds;
      kind["estimated_seconds"] = kind["estimated_seconds"].get<double>() + unit.seconds;
    }
    if (out.left > left) out.open.push_back(shard);
  }
  return {};
}

}  // namespace sinew::batch
