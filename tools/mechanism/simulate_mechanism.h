// `sinew simulate` for mechanisms: names of formulations and integrators, run, table and telemetry.
#pragma once

#include "mechanism/mechanism_file.h"

namespace sinew::mechanism {

struct SimulateOptions {
  std::string formulation = "RR-JF";   ///< see formulation_names
  std::string integrator = "ode15sR";  ///< see integrator_names
  double rtol = 1e-5, atol = 1e-5;
  double max_step = 0;       ///< s; 0: none but the file's profiles
  double fixed_step = 1e-3;  ///< s; bdf1 and bdf2
  double t_end = 0;          ///< s; 0: the file's
  long max_steps = 1000000;
  int intervals = 50;            ///< equally spaced samples, unless `instants` are given
  std::vector<double> instants;  ///< s
};

/// What --formulation and --integrator accept. "-Rz" may be left out: loops decide.
const std::vector<std::string>& formulation_names();
const std::vector<std::string>& integrator_names();

/// Names to settings; both must be among the names above.
multibody::SimulationSettings settings_of(const SimulateOptions& options);

/// Runs the mechanism. "" or why it ended early (`result` then holds what was computed until then).
std::string simulate_mechanism(const multibody::Model& model, const SimulateOptions& options,
                               const std::function<void(double)>& progress,
                               multibody::SimulationResult& result);

/// Steps, evaluations, CPU time, closure error and energy balance of a run.
nlohmann::json telemetry(const multibody::Model& model, const SimulateOptions& options,
                         const multibody::SimulationResult& result);

}  // namespace sinew::mechanism
