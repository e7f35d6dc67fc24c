// `sinew completion` and `sinew man`: the command line told to shells and to man.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "convert/convert.h"

namespace sinew::cli {

struct ManualCommand {
  std::string shell, page, directory;

  void add(CLI::App& app);
  bool parsed() const;
  /// `app`: the whole program.
  convert::Error run(const CLI::App& app) const;

  /// The command line of this program and of the one that it becomes for studies (see describe()).
  static nlohmann::json described(const CLI::App& app);

 private:
  CLI::App *completion_ = nullptr, *man_ = nullptr;
};

}  // namespace sinew::cli
