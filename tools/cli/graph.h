// `sinew graph`: checks, compiles, draws and plays graphs of clips.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "convert/convert.h"

namespace sinew::cli {

struct GraphCommand {
  std::string input, output, asset, script, joint;
  double seconds = 10, rate = 60;
  bool json_output = false;

  void add(CLI::App& app);
  /// Faults of the graph are the error; what is unsmooth makes `check --strict` fail.
  convert::Error run();

 private:
  convert::Error check() const;
  convert::Error compile() const;
  convert::Error dot() const;
  convert::Error trace();
  bool strict_ = false;
  CLI::App *check_ = nullptr, *compile_ = nullptr, *dot_ = nullptr, *trace_ = nullptr;
};

}  // namespace sinew::cli
