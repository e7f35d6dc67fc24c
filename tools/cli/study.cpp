#include "cli/study.h"

#include <cstdio>
#include <filesystem>

#include "cli/files.h"
#include "study/study.h"

namespace sinew::cli {

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
  if (json_output)
    std::puts(summary.dump().c_str());
  else
    std::printf("%d cases passed, %d failed; %s/stability.csv\n", summary["passed"].get<int>(),
                summary["failed"].get<int>(), directory.c_str());
  return {};
}

}  // namespace sinew::cli
