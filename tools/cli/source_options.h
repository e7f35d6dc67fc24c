// Options that all commands share which read sources: how to convert them.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::cli {

struct SourceOptions {
  std::string options_file, clip_data, up, facing;
  double unit = 0;
  std::vector<std::string> packages;  ///< NAME=DIR

  void add(CLI::App& app);
  /// The same again, for another process.
  std::vector<std::string> arguments() const;
  /// As conversion options.
  convert::Error read(nlohmann::json& out) const;
};

}  // namespace sinew::cli
