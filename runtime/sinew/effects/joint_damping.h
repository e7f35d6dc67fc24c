// What a skeleton's joints lose: dry friction, a kink at where the step began, and viscous damping, the
// potential c/(2h)·s² of the way s since then.
#pragma once

#include "sinew/effects/joint_step.h"

namespace sinew {

template <class T>
class JointDampingRows {
 public:
  static bool act(const JointStep<T>& joint) {
    const JointLaw<T>& law = joint.law;
    return joint.any([&](int dof) { return law.dry_friction[dof] > T(0) || law.damping[dof] > T(0); });
  }
  explicit JointDampingRows(const JointStep<T>& joint);

  void append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const;

 private:
  JointOffset<T> from_start_;
};

extern template class JointDampingRows<float>;
extern template class JointDampingRows<double>;

}  // namespace sinew
