// Work per evaluation of serial chains against their number of bodies.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sinew/multibody/mechanism.h"

namespace sinew::study {

struct ChainPoint {
  int links = 0;
  double dtr = 0, dsr = 0, rr = 0;                                         ///< µs per evaluation
  double dtr_instructions = 0, dsr_instructions = 0, rr_instructions = 0;  ///< counted; 0: not counted
};

/// Rods of 0.1 m and 0.1 kg, hinges alternately about x and y.
multibody::Mechanism chain_of(int links);

/// Chains of 5 … 1000 links (5 … 200 when `quick`). `recount`: see TablesOptions.
std::vector<ChainPoint> measure_chains(bool quick, bool recount, const std::function<void()>& done_one);

/// Exponent p of cost ~ links^p over the chains of at least `from` links; 0 where nothing was counted.
double growth_exponent(const std::vector<ChainPoint>& chains, double ChainPoint::*cost, int from);

std::string chains_csv(const std::vector<ChainPoint>& chains);
/// Draws the CSV with gnuplot, double logarithmic. "" or what is wrong.
std::string plot_chains(const std::string& csv, const std::string& png);

}  // namespace sinew::study
