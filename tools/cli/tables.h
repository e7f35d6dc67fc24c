// `sinew study tables`: the tables of the paper, measured here.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "convert/convert.h"

namespace sinew::cli {

struct TablesCommand {
  std::string directory = "out/study", mechanisms;
  double tolerance = 1e-5;
  bool quick = false, json_output = false;

  convert::Error run() const;
};

void add_options(CLI::App& app, TablesCommand& command);

}  // namespace sinew::cli
