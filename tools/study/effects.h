// What each effect costs: instructions by callgrind, time, memory; fixed and per instance.
#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::study {

constexpr std::array<int, 4> kInstances{0, 1, 8, 64};

/// One effect in one mode of the counting program (tools/study/effect_cost/main.cpp says which there are).
struct EffectCost {
  std::string effect, mode;
  std::string instance;    ///< what one is; empty: it is on or off, and costs the same at 1, 8 and 64
  std::string not_linear;  ///< why, where a straight line does not fit
  std::array<double, 4> instructions{};  ///< per step; negative: not counted
  std::array<double, 4> microseconds{};  ///< per step, the least of some runs
  std::array<double, 4> bytes{};
  // Of what is above the step without the effect, at 1, 8 and 64 instances:
  double fixed = 0, each = 0;  ///< instructions
  double misfit = 0;           ///< largest share by which a straight line misses
};

struct EffectStudy {
  std::string machine;          ///< processor and compiler
  std::string counted_by;       ///< valgrind's version; empty where there is none
  double bare = -1, step = -1;  ///< instructions of kinematics and residual alone, and of a zero-effect step
  std::vector<EffectCost> costs{};
};

struct EffectOptions {
  std::string program;    ///< the counting program
  std::string directory;  ///< for its temporary files
  bool quick = false;     ///< fewer timed steps
  std::string mode{};     ///< only what is counted in this mode; empty: everything
};

/// Fits the straight line, relative misfits weighing alike.
void fit(EffectCost& cost);
/// Instructions per step of the counting program with these arguments (MODE EFFECT INSTANCES), by callgrind;
/// −1 where that is not to be had.
double count_instructions(const EffectOptions& options, const std::string& arguments);
convert::Error run_effects(const EffectOptions& options, const std::function<void(int, int)>& progress,
                           EffectStudy& out);

std::string effects_table(const EffectStudy& study);  ///< Markdown
std::string effects_csv(const EffectStudy& study);
nlohmann::json effects_json(const EffectStudy& study);
/// Added instructions against instances, .png or .svg by the ending.
convert::Error draw_effects(const EffectStudy& study, const std::string& file);

}  // namespace sinew::study
