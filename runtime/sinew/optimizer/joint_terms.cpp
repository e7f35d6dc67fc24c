#include "sinew/optimizer/joint_terms.h"

#include "sinew/optimizer/joint_terms_pass.h"

namespace sinew {

template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  measure_rows<T>(settings, settings.plan->joints, p);
}

template <class T>
void measure_joint_curvature(const StepSettings<T>& settings, TreeProblem<T>& p) {
  measure_curvature<T>(settings.plan->joints, p);
}

SINEW_JOINT_TERMS_INSTANCES(template, float)
SINEW_JOINT_TERMS_INSTANCES(template, double)

}  // namespace sinew
