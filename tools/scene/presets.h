// The accuracy dial of scene files and of `sinew simulate`: presets by name, or the cheapest measured setting
// within an error or a time. The data are assets/accuracy_presets.json, made by `sinew study accuracy` and
// built in.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"
#include "sinew/optimizer/accuracy.h"

namespace sinew::scene {

/// A setting with what it was measured to do (tools/study/README.md says on which scenes).
struct MeasuredAccuracy {
  std::string name;   ///< of a preset, or empty
  Accuracy accuracy;  ///< substeps are those of a step of 1/60 s
  bool double_precision = false;
  double error = 0, degrees = 0;  ///< m; rms of joint angles
  double us = 0;  ///< per character and 1/60 s while it is pushed, on the machine of the data file
};

/// What was measured may be off by so much on a scene that nobody measured: the dial asks for that much less.
constexpr double kDialSafety = 2;

const std::vector<MeasuredAccuracy>& accuracy_presets();
const std::vector<MeasuredAccuracy>& accuracy_front();

convert::Error find_preset(const std::string& name, MeasuredAccuracy& out);
/// `wanted`: a number with its unit, "1mm", "2cm", "0.05m" or "2deg".
convert::Error within_error(const std::string& wanted, MeasuredAccuracy& out);
/// The most accurate that costs no more: "20us", "1ms".
convert::Error within_budget(const std::string& wanted, MeasuredAccuracy& out);

/// Takes substeps and tolerance over for steps of 1/frame_rate s; what says how a scene behaves
/// (contacts, limits, return time) stays.
void set_accuracy(const MeasuredAccuracy& measured, double frame_rate, Accuracy& accuracy,
                  bool& double_precision);

}  // namespace sinew::scene
