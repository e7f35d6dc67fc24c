// Instructions of simulations and evaluations, counted by callgrind: the same on a busy machine, where a
// clock is not.
#pragma once

#include <string>
#include <vector>

namespace sinew::study {

/// What is counted: a simulation, or one derivative or residual where `integrator` is empty.
struct CountJob {
  std::string mechanism;    ///< NAME of DIRECTORY/NAME.json, or "chain:N" for a serial chain of N links
  std::string formulation;  ///< "RR-JF", …
  std::string integrator;   ///< "ode15sR", …
  double tolerance = 0;     ///< relative and absolute
};

/// Whether valgrind and the program that it runs are there.
bool can_count();

/// Instructions of each job, in their order; 0 for one that could not be run. All run in two processes under
/// callgrind, fifty times slower than by themselves. What was counted stands beside the program that ran,
/// until that is built anew or the mechanism's file changes: a study that was stopped goes on where it was.
/// `anew`: is counted again all the same.
std::vector<double> count(const std::string& directory, const std::vector<CountJob>& jobs, bool anew);

/// One line of the list, and back.
std::string line_of(const CountJob& job);
CountJob job_of(const std::string& line);

}  // namespace sinew::study
