// `sinew study`: the evidence, as tables, CSV, JSON and pictures.
#pragma once

#include <string>

#include "convert/convert.h"

namespace sinew::cli {

struct StabilityCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false;

  convert::Error run() const;
};

struct AccuracyCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false, ensembles = false;

  convert::Error run() const;

 private:
  convert::Error run_ensembles() const;
  convert::Error write_presets(nlohmann::json& dial) const;
};

struct ScenesCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false;
  bool talk = false;  ///< the seed talk's scenes, not the ordinary situations

  convert::Error run() const;
};

struct EffectsCommand {
  std::string directory = "out/study";
  bool quick = false, json_output = false;

  convert::Error run() const;
};

}  // namespace sinew::cli
