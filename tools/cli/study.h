// `sinew study`: the evidence, as tables, CSV, JSON and pictures.
#pragma once

#include <string>

#include "convert/convert.h"
#include "study/accuracy_clock.h"
#include "study/accuracy_report.h"

namespace sinew::cli {

struct StabilityCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false;

  convert::Error run() const;
};

struct AccuracyCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false, ensembles = false;
  int exit_code = 1;  ///< of an error; kBusy where all is written but presets

  static constexpr int kBusy = 3;

  convert::Error run();

 private:
  convert::Error run_ensembles() const;
  convert::Error run_all(study::AccuracyReport& report, study::MachineCheck& machine) const;
  convert::Error write(const study::AccuracyReport& report) const;
};

struct ScenesCommand {
  std::string directory = "out/study", only;
  bool quick = false, json_output = false;
  bool talk = false;  ///< the seed talk's scenes, not the ordinary situations

  convert::Error run() const;
};

struct BehaviourCommand {
  std::string directory = "out/study";
  int directions = 0, seeds = 0;  ///< 0: as many as the form has
  bool quick = false, json_output = false;

  convert::Error run() const;
};

struct EffectsCommand {
  std::string directory = "out/study";
  bool quick = false, json_output = false;

  convert::Error run() const;
};

}  // namespace sinew::cli
