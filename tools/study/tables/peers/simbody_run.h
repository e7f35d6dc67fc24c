// One simulation by Simbody, in C++17 (its headers do not compile as C++20): plain data in and out.
#pragma once

#include <string>
#include <vector>

#include "sinew/multibody/mechanism.h"

namespace sinew::study {

struct SimbodyRun {
  bool cpodes = false;  ///< its CPodes (BDF, Newton), else Runge–Kutta–Merson
  double accuracy = 1e-5;
  double max_step = 0;           ///< s; 0: none
  std::vector<double> instants;  ///< s, ascending

  std::vector<std::vector<double>> rows;  ///< q of all joints, then their rates, per instant
  long steps = 0, evaluations = 0;
  double seconds = 0;   ///< CPU time of the integration
  std::string stopped;  ///< "" or why it ended early
};

void simulate_with_simbody(const multibody::Mechanism& mechanism, SimbodyRun& run);

}  // namespace sinew::study
