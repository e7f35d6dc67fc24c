#include "sinew/effects/joint_damping.h"

namespace sinew {

template <class T>
void JointDamping<T>::declare(StepPlan<T>& plan) {
  plan.joints.damping = &JointDampingRows<T>::kTerm;
}

template struct JointDamping<float>;
template struct JointDamping<double>;

}  // namespace sinew
