// Comparing costs: at the same tolerance, and at the same true error. In instructions, never in time.
#pragma once

#include <initializer_list>

#include "study/tables/tables.h"

namespace sinew::study {

/// How many times as many instructions `b` needs as `a` does; 0 where one was not counted.
struct Ratio {
  double at_tolerance = 0;  ///< both at the paper's tolerance
  double at_error = 0;      ///< both at the error in positions that the less accurate of them has there

  bool known() const { return at_tolerance > 0 && at_error > 0; }
  bool above(double bound) const { return at_tolerance > bound && at_error > bound; }
  bool below(double bound) const { return known() && at_tolerance < bound && at_error < bound; }
  std::string text() const;  ///< "1.92, 2.10"
};

using Methods = std::vector<std::string>;  ///< "ode15sR · RR-JF", …

/// The cheapest of `b` over the cheapest of `a`, each chosen for itself at tolerance and at error.
Ratio ratio(const TablesResult& r, const std::string& mechanism, const Methods& a, const Methods& b);

/// Instructions of a method at an error: on the lower envelope of its runs, between which the logarithms are
/// joined by straight lines. Beyond its loosest run that run's; 0 when none comes near.
double cost_at_error(const TablesResult& r, const std::string& mechanism, const std::string& method,
                     double error);

/// The rows of a mechanism whose integrator is among these.
Methods methods_of(const TablesResult& r, const std::string& mechanism,
                   std::initializer_list<const char*> integrators);

}  // namespace sinew::study
