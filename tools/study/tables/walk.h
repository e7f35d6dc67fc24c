// An integrator walked to the end of a mechanism's time, for rows that only the study has: RADAU5, and global
// formulations (global/cartesian_equations.h). The runtime's own are walked by multibody::simulate.
#pragma once

#include "study/tables/measure.h"

namespace sinew::study {

/// Whether the row is one of these: "RADAU5" as integrator, or a formulation that begins with "Cartesian".
bool only_in_the_study(const std::string& formulation, const std::string& integrator);

/// "" or why there is no such row: what an unknown name is and which are known, or what does not go together.
std::string fault_of_row(const multibody::Model& model, const std::string& formulation,
                         const std::string& integrator);

/// Runs it once and fills what SimulationRun holds; the samples at `instants` go to `out`.
void walk(const multibody::Model& model, const std::string& formulation, const std::string& integrator,
          double tolerance, const std::vector<double>& instants, SimulationRun& run, Trajectory& out);

/// Derivatives of a global formulation, as evaluations_of.
EvaluationWork global_evaluations(const StudyCase& c, const std::string& formulation);

}  // namespace sinew::study
