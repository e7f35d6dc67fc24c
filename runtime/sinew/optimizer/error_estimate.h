// How far one step goes astray because it is finite: an embedded estimate, from what the step leaves behind.
//
// The formula of one order higher, on the same states, differs by (κ − 1/6) h² (a₁ − a₀), where accelerations
// change as t³/6 has it; a of a body's centre, or its angular acceleration. No second solve: about 60 flops per
// body. Of a step of implicit Euler (a restart) it is h²/2 · a₁; of other schemes than the runtime's nothing.
// Step doubling was not taken, since it costs two more solves. What it cannot see: a solve that stopped short
// of its tolerance (CharacterReport::converged says so), and which of two ways an impact goes.
#pragma once

#include "sinew/optimizer/problem.h"
#include "sinew/optimizer/scheme.h"

namespace sinew {

/// Root mean square over all mass (m) of the local error of the step of `h` seconds that `problem` holds the
/// solution of; to be asked before `history` moves on. `load` [dof]: |torque| / limit of the muscles. Bodies
/// that hang on played or unsaturated joints alone are where the animation wants them: they count with 0.
template <class T>
double integration_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load,
                         T h);

extern template double integration_error<float>(const TreeProblem<float>&, const History<float>&,
                                                std::span<const float>, float);
extern template double integration_error<double>(const TreeProblem<double>&, const History<double>&,
                                                 std::span<const double>, double);

}  // namespace sinew
