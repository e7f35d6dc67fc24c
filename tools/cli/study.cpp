#include "cli/study.h"

#include <cstdio>
#include <filesystem>

#include "cli/files.h"
#include "study/maps.h"
#include "study/study.h"

namespace sinew::cli {

convert::Error StabilityCommand::draw_maps() const {
  const auto draw = [&](const study::FailureMap& map, const std::string& name) {
    const std::string file = directory + "/" + name;
    if (convert::Error error = write_atomically(file + ".csv", study::map_csv(map))) return error;
    if (convert::Error error = study::draw_map(map, file + ".svg")) return error;
    return study::draw_map(map, file + ".png");
  };
  if (convert::Error error =
          draw(study::map_of_speeds(quick, progress_bar("joint speeds")), "failure_map_speed"))
    return error;
  return draw(study::map_of_masses(quick, progress_bar("mass ratios")), "failure_map_mass");
}

convert::Error StabilityCommand::run() const {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) return {directory + ": cannot be made: " + failed.message()};
  if (!json_output) std::fputs(study::stability_table_head().c_str(), stdout);
  const auto print = [&](const study::StabilityResult& result) {
    if (json_output) return;
    std::fputs(study::stability_table(result).c_str(), stdout);
    std::fflush(stdout);
  };
  const auto results =
      study::run_stability({quick, only}, json_output ? progress_bar("stability") : nullptr, print);
  if (results.empty()) return {"there is no hard case '" + only + "'"};
  const nlohmann::json summary = study::stability_json(results);
  if (convert::Error error = write_atomically(directory + "/stability.csv", study::stability_csv(results)))
    return error;
  if (only.empty() && !json_output)
    if (convert::Error error = draw_maps()) return error;
  if (json_output)
    std::puts(summary.dump().c_str());
  else
    std::printf("%d cases passed, %d failed; %s/stability.csv\n", summary["passed"].get<int>(),
                summary["failed"].get<int>(), directory.c_str());
  return {};
}

}  // namespace sinew::cli
