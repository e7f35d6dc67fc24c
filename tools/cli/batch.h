// `sinew batch`: plans of many conversions, renderings and studies, for one machine or for many.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "batch/run.h"
#include "batch/slurm.h"

namespace sinew::cli {

struct BatchCommand {
  std::string manifest, directory, part, output;
  batch::Run run_options;
  batch::Submit submit_options;
  bool json_output = false;
  int exit_code = 1;  ///< of an error; kNotFinished where running again helps

  static constexpr int kNotFinished = 4;

  void add(CLI::App& app);
  convert::Error run();

 private:
  convert::Error plan() const;
  convert::Error run_shards(const batch::Plan& plan);
  convert::Error status(const batch::Plan& plan);
  convert::Error merge(const batch::Plan& plan);
  convert::Error submit(const batch::Plan& plan) const;
  CLI::App *plan_ = nullptr, *run_ = nullptr, *status_ = nullptr, *merge_ = nullptr, *submit_ = nullptr;
};

}  // namespace sinew::cli
