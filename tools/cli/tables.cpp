#include "cli/tables.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "cli/files.h"
#include "cli/terminal.h"
#include "study/tables/tables.h"

namespace sinew::cli {

using convert::Error;

void add_options(CLI::App& app, TablesCommand& command) {
  app.add_option("-o,--output", command.directory, "directory for text, CSV, JSON and the plot")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--mechanisms", command.mechanisms, "directory of mechanism files")
      ->type_name("DIR")
      ->default_str("assets/mechanisms");
  app.add_option("--tolerance", command.tolerance, "relative and absolute")
      ->check(CLI::Range(1e-12, 1e-1))
      ->capture_default_str();
  app.add_flag("--quick", command.quick, "fewer repeats and tolerances");
  app.add_flag("--json", command.json_output, "results on standard output as JSON");
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
                                      {base + ".json", json_text(summary, 2) + "\n"},
                                      {chains + ".csv", study::chains_csv(result.chains)}})
    if (Error error = write_atomically(path, content)) return error;
  if (const std::string why = study::plot_chains(chains + ".csv", chains + ".png"); !why.empty())
    say_error(why);
  const bool bold = !styled("", Style::kBold, STDOUT_FILENO).empty();
  if (json_output)
    std::puts(json_text(summary).c_str());
  else
    say("%s\n%s.md, .csv, .json; %s.csv, .png\n",
        study::tables_text(result, bold ? "\033[1m" : "**", bold ? "\033[0m" : "**").c_str(), base.c_str(),
        chains.c_str());
  return {};
}

}  // namespace sinew::cli
