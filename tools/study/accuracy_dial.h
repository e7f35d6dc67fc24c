// The dial: settings of a 1/60 s step measured on the study's scenes, and the presets chosen from them.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/accuracy.h"
#include "study/accuracy_clock.h"

namespace sinew::study {

/// A setting with what it was measured to do.
struct DialPoint {
  EngineOption option;
  Accuracy accuracy;   ///< substeps are those of a step of 1/60 s
  double error = 0;    ///< m, the largest over the scenes by which presets are chosen
  double degrees = 0;  ///< where muscles follow a clip and are pushed
  double us = 0;       ///< processor time per 1/60 s and character, there
  double us_limp = 0;  ///< and of a character that collapses
  double us_p99 = 0, us_worst = 0, us_limp_p99 = 0,
         us_limp_worst = 0;  ///< over the frames, see frame_costs()
  bool precise() const { return option.option.find("double") != std::string::npos; }
};

/// Names of the scenes that count: free motion, contact and muscles. Not the drop: after an impact a run does
/// not converge in the step, so no setting could promise anything.
std::vector<std::string> dial_scenes();

/// Measures all candidates; `quick` takes a tenth of them and fewer repetitions.
std::vector<DialPoint> measure_dial(bool quick, const std::function<void(int, int)>& progress);

/// Those that nothing measured beats in cost, error and degrees together; cheapest first.
std::vector<DialPoint> dial_front(std::vector<DialPoint> points);

/// The data file: where and when it was measured, the front, the presets. A preset that is no other setting
/// than the next stricter one says so in "same_as".
nlohmann::json dial_json(const std::vector<DialPoint>& front, const std::string& machine,
                         const std::string& date);
/// The same presets as a header of the runtime.
std::string dial_header(const nlohmann::json& dial);

/// Hands accuracy_presets.json and presets.h to `write` (path, text). Where the machine was busy nothing is
/// written: times decide which settings these are.
convert::Error store_presets(
    const nlohmann::json& dial, const std::string& directory, const MachineCheck& machine,
    const std::function<convert::Error(const std::string&, const std::string&)>& write);

}  // namespace sinew::study
