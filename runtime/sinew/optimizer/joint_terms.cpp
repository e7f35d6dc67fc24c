#include "sinew/optimizer/joint_terms.h"

#include "sinew/optimizer/joint_terms_pass.h"

namespace sinew {

template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  measure_rows<T>(settings, p);
}

template <class T>
void measure_joint_curvature(TreeProblem<T>& p) {
  measure_curvature<T>(p);
}

SINEW_JOINT_TERMS_INSTANCES(template, float)
SINEW_JOINT_TERMS_INSTANCES(template, double)

}  // namespace sinew
