#include "sinew/optimizer/joint_terms.h"

#include "sinew/optimizer/joint_terms_pass.h"

namespace sinew {

template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  measure_rows<T>(settings, settings.plan->joints, p);
}

template <class T>
void append_limit_rows(const StepSettings<T>& settings, TreeProblem<T>& p, int i) {
  const auto joint = joint_step<T>(settings, p, i);
  const JointTerms<T>& terms = settings.plan->joints;
  JointOffset<T> offset;
  if (terms.limits && terms.limits->look(joint, offset, p))
    for (int k = 0; k < joint.dofs(); ++k) terms.limits->append(joint, offset, k, p);
  if (terms.cones && p.law.swing_limit[i] >= 0) terms.cones->append(joint, p);
}

template <class T>
void measure_joint_curvature(const StepSettings<T>& settings, TreeProblem<T>& p) {
  measure_curvature<T>(settings.plan->joints, p);
}

SINEW_JOINT_TERMS_INSTANCES(template, float)
SINEW_JOINT_TERMS_INSTANCES(template, double)

}  // namespace sinew
