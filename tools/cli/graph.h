// `sinew graph`: checks, compiles, draws and plays graphs of clips.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "convert/convert.h"
#include "graph/compile.h"
#include "sinew/graph/graph.h"

namespace sinew::cli {

struct GraphCommand {
  std::string input, output, asset, script, joint, recording;
  double seconds = 10, rate = 60;
  int frames = 120;
  bool json_output = false;

  void add(CLI::App& app);
  /// Faults of the graph are the error; what is unsmooth makes `check --strict` fail.
  convert::Error run();

 private:
  convert::Error check() const;
  convert::Error compile() const;
  convert::Error dot() const;
  convert::Error trace();
  convert::Error replay() const;
  convert::Error plot() const;
  /// The graph of the command with its asset.
  convert::Error bind(Asset& with, graph_tools::Compiled& compiled, Graph& graph) const;
  bool strict_ = false;
  CLI::App *check_ = nullptr, *compile_ = nullptr, *dot_ = nullptr, *trace_ = nullptr, *replay_ = nullptr,
           *plot_ = nullptr;
};

}  // namespace sinew::cli
