// A mechanism over time: formulation × integrator, sampled states, and what it cost.
#pragma once

#include <functional>

#include "sinew/multibody/equations.h"
#include "sinew/multibody/integrator.h"

namespace sinew::multibody {

struct SimulationSettings {
  Formulation formulation = Formulation::kRr;
  Tangent tangent = Tangent::kAnalytic;
  Closure closure = Closure::kInEvaluations;
  Method method = Method::kOde15sR;
  IntegratorSettings integrator;
  double t_end = 0;            ///< s; 0: the file's
  long max_steps = 1000000;    ///< then it stops: a motion too fast for its tolerance would go on for hours
  std::vector<double> output;  ///< instants to sample, ascending
  bool energy = false;         ///< also integrate the power of what is not conservative
};

/// "" or why this formulation and this integrator do not go together for this mechanism.
std::string mismatch(const Model& model, const SimulationSettings& settings);

struct Sample {
  double t = 0;
  Vector y;  ///< q, q'; loops closed to rounding
  double kinetic = 0, potential = 0;
  double closure = 0;  ///< largest loop error in y, m
  double work = 0;     ///< J since the start of what `potential` leaves out; only with `energy`
  std::vector<Vec3<double>> points;
};

struct SimulationResult {
  std::vector<Sample> samples;
  std::string stopped;  ///< "" or when and why the integration ended before t_end
  double seconds = 0;   ///< CPU time of this thread for the integration, s
  StepCounts steps;
  EvaluationCounts evaluations;
  bool looks_stiff = false;
};

/// A mechanism that cannot be started (Equations::start) is reported as `stopped`, without samples. An
/// integration that ends early keeps the samples until then and adds the last state reached. `progress` is
/// called with the time reached now and then; it may be empty.
SimulationResult simulate(const Model& model, const SimulationSettings& settings,
                          const std::function<void(double)>& progress = {});

/// Equally spaced instants 0 … t_end.
std::vector<double> instants(double t_end, int intervals);

}  // namespace sinew::multibody
