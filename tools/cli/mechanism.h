// `sinew simulate MECHANISM.json`: the reference family on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include "convert/convert.h"
#include "mechanism/simulate_mechanism.h"

namespace sinew::cli {

/// Adds --formulation, --integrator, … to `sinew simulate`.
void add_mechanism_options(CLI::App& simulate, mechanism::SimulateOptions& options);

/// Runs the file and writes its table: `output` .csv (samples) or .json (telemetry). What was computed is
/// written also when the integration stops early, and the error then says when and why.
convert::Error run_mechanism(const std::string& path, const mechanism::SimulateOptions& options,
                             const std::string& output, bool json_output);

}  // namespace sinew::cli
