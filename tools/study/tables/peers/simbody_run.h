// One simulation by Simbody, plain data in and out. It is a module of its own, loaded at run time: Simbody's
// headers do not compile as C++20, and its library carries an old SUNDIALS whose symbols clash with those of
// the present one.
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
  std::vector<bool> one_angle;   ///< [loop], see SimbodyModel

  std::vector<std::vector<double>> rows;  ///< q of all joints, then their rates, per instant
  long steps = 0, evaluations = 0;
  double seconds = 0;   ///< CPU time of the integration
  std::string stopped;  ///< "" or why it ended early
};

}  // namespace sinew::study

extern "C" void sinew_simulate_with_simbody(const sinew::multibody::Mechanism& mechanism,
                                            sinew::study::SimbodyRun& run);
