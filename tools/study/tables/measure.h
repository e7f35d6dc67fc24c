// Measuring the reference family: mechanisms with their references, time of one evaluation, time and true
// error of one simulation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mechanism/simulate_mechanism.h"

namespace sinew::study {

/// Largest |difference|/(1 + |value|) over all coordinates and sampled instants.
struct TrueError {
  double q = 0, u = 0;
  bool within(const TrueError& other) const { return q <= other.q && u <= other.u; }
};

/// Coordinates and rates of all joints at given instants.
struct Trajectory {
  std::vector<double> t;
  std::vector<multibody::Vector> y;  ///< q, q'
};

TrueError error_of(const Trajectory& trajectory, const Trajectory& reference);

/// A mechanism of the study and what its motion truly is.
struct StudyCase {
  std::string name;
  multibody::Mechanism mechanism;
  Trajectory reference;
  bool stiff = false;
  bool closed() const { return !mechanism.loops.empty(); }
};

/// Reads DIRECTORY/NAME.json and DIRECTORY/reference/NAME.csv; without the latter the reference is DE at
/// 1e-12. What a table leaves out is not a number in the reference, and not compared.
/// "" or what is wrong.
std::string load_case(const std::string& directory, const std::string& name, StudyCase& out);
/// The same without a reference where there is no table; "chain:N" is a serial chain of N links.
std::string load_mechanism_only(const std::string& directory, const std::string& name, StudyCase& out);

/// One simulation: which, how long, how true.
struct SimulationRun {
  std::string mechanism;
  std::string method;       ///< "DE · DTR", "Simbody · CPodes", …
  double tolerance = 0;     ///< relative and absolute
  double milliseconds = 0;  ///< CPU time of the integration, best of the repeats
  double instructions = 0;  ///< of the integration, counted (count.h); 0: not counted
  TrueError error;
  long steps = 0, evaluations = 0, tangents = 0, factorisations = 0;
  double closure = 0;       ///< m
  double energy_drift = 0;  ///< J; of conservative mechanisms
  std::string stopped;      ///< "" or why there is no figure
};

/// CPU time of this thread, s.
double cpu_seconds();

/// Simulates with the runtime, or with what only the study has (walk.h); `repeats` times, the quickest
/// counts.
SimulationRun measure(const StudyCase& c, const std::string& formulation, const std::string& integrator,
                      double tolerance, int repeats);

/// A simulation to be run once, without sampling: what is counted.
std::function<void()> simulation_of(const StudyCase& c, const std::string& formulation,
                                    const std::string& integrator, double tolerance);

/// Derivatives (DTR, DSR, global formulations) or residuals (RR) at states of the reference, moved by 1e-6
/// like an integrator's predictions; without a reference at the start. Each call of `run` evaluates all of
/// them.
struct EvaluationWork {
  std::function<void()> run;
  int evaluations = 0;
};
EvaluationWork evaluations_of(const StudyCase& c, const std::string& formulation);
/// How many evaluations one call makes.
int evaluations_per_run(const std::string& mechanism);

/// Time of one evaluation in µs: best of repeats.
double evaluation_time(const StudyCase& c, const std::string& formulation, int repeats);

}  // namespace sinew::study
