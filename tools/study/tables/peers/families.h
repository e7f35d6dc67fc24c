// The peers by package, and what they share.
#pragma once

#include <limits>

#include "study/tables/peers.h"

namespace sinew::study {

std::vector<Peer> simbody_peers();   ///< own model and equations: a whole other program
std::vector<Peer> sundials_peers();  ///< general-purpose integrators on Sinew's equations
std::vector<Peer> odeint_peers();    ///< the same

/// Repeats `simulate(trajectory, measurement)`, which answers "" or why it stopped and adds nothing to the
/// CPU time but the integration; fills error and the quickest time.
template <class Simulate>
SimulationRun measure_peer(const std::string& name, const StudyCase& c, double tolerance, int repeats,
                           Simulate simulate) {
  SimulationRun m;
  m.mechanism = c.name;
  m.method = name;
  m.tolerance = tolerance;
  m.milliseconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats && m.stopped.empty(); ++i) {
    Trajectory trajectory;
    double seconds = 0;
    m.stopped = simulate(trajectory, m, seconds);
    m.milliseconds = std::min(m.milliseconds, 1e3 * seconds);
    m.error = error_of(trajectory, c.reference);
  }
  return m;
}

/// What a general-purpose integrator sees: derivatives by DTR (open) or DSR-Rz (closed).
inline multibody::Formulation derivatives_of(const StudyCase& c) {
  return c.closed() ? multibody::Formulation::kDsr : multibody::Formulation::kDtr;
}

}  // namespace sinew::study
