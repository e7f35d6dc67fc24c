#include "cli/tables.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "cli/files.h"
#include "study/tables/tables.h"

namespace sinew::cli {

using convert::Error;

void add_options(CLI::App& app, TablesCommand& command) {
  app.add_option("-o,--output", command.directory, "directory for text, CSV, JSON and the plot (out/study)");
  app.add_option("--mechanisms", command.mechanisms, "directory of mechanism files (assets/mechanisms)");
  app.add_option("--tolerance", command.tolerance, "relative and absolute (1e-5)")
      ->check(CLI::Range(1e-12, 1e-1));
  app.add_flag("--quick", command.quick, "fewer repeats and tolerances");
  app.add_flag("--json", command.json_output);
}

Error TablesCommand::run() const {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) return {directory + ": cannot be made: " + failed.message()};
  study::TablesResult result;
  if (std::string why =
          study::run_tables({mechanisms, tolerance, quick, {}}, progress_line("tables"), result);
      !why.empty())
    return {why};
  const nlohmann::json summary = study::tables_json(result);
  const std::string base = directory + "/tables", chains = directory + "/chains";
  for (const auto& [path, content] : {std::pair{base + ".md", study::tables_text(result, "**", "**")},
                                      {base + ".csv", study::tables_csv(result)},
                                      {base + ".json", summary.dump(2) + "\n"},
                                      {chains + ".csv", study::chains_csv(result.chains)}})
    if (Error error = write_atomically(path, content)) return error;
  if (const std::string why = study::plot_chains(chains + ".csv", chains + ".png"); !why.empty())
    std::fprintf(stderr, "sinew: %s\n", why.c_str());
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  if (json_output)
    std::puts(summary.dump().c_str());
  else
    std::printf("%s\n%s.md, .csv, .json; %s.csv, .png\n",
                study::tables_text(result, terminal ? "\033[1m" : "**", terminal ? "\033[0m" : "**").c_str(),
                base.c_str(), chains.c_str());
  return {};
}

}  // namespace sinew::cli
