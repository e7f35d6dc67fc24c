// Rows of a tree's free joints at the present pose: muscles, dry friction, damping, limits and cones.
#pragma once

#include "sinew/optimizer/problem.h"

namespace sinew {

/// Fills `problem.rows` and `problem.ellipsoids` for all free joints at `problem.local`, in the order of the
/// bodies. O(free DOFs).
template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& problem);

/// Appends the limits and cone of one joint to `problem.rows`, at `problem.local`, whether it is free or not.
template <class T>
void append_limit_rows(const StepSettings<T>& settings, TreeProblem<T>& problem, int joint);

/// Second derivatives of the rows' scalars times their slopes, per ball or free joint: the geometric term of
/// its own three rotations, `problem.joint_curvature`. Zero for joints without active rows. Call after
/// measure_joint_rows.
template <class T>
void measure_joint_curvature(const StepSettings<T>& settings, TreeProblem<T>& problem);

#define SINEW_JOINT_TERMS_INSTANCES(prefix, T)                                    \
  prefix void measure_joint_rows<T>(const StepSettings<T>&, TreeProblem<T>&);     \
  prefix void append_limit_rows<T>(const StepSettings<T>&, TreeProblem<T>&, int); \
  prefix void measure_joint_curvature<T>(const StepSettings<T>&, TreeProblem<T>&);
SINEW_JOINT_TERMS_INSTANCES(extern template, float)
SINEW_JOINT_TERMS_INSTANCES(extern template, double)

}  // namespace sinew
