// Independent programs on the same mechanisms: SUNDIALS, Boost.Odeint, Simbody (only with SINEW_PEERS).
#pragma once

#include <functional>

#include "study/tables/measure.h"

namespace sinew::study {

/// One program with one of its integrators. `measure` simulates at a tolerance, the quickest of `repeats`
/// counts.
struct Peer {
  std::string name;
  bool stiff_too =
      true;  ///< false: stability limits it on stiff mechanisms; measured there once, not repeated
  std::function<SimulationRun(const StudyCase&, double tolerance, int repeats)> measure;
};

/// All that this build knows; none without SINEW_PEERS.
std::vector<Peer> peers();

}  // namespace sinew::study
