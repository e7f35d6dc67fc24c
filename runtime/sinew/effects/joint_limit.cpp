#include "sinew/effects/joint_limit.h"

namespace sinew {

template <class T>
void JointLimits<T>::declare(StepPlan<T>& plan) {
  plan.joints.limits = &JointLimitRows<T>::kTerm;
  plan.joints.cones = &ConeRows<T>::kTerm;
}

template struct JointLimits<float>;
template struct JointLimits<double>;

}  // namespace sinew
