// Muscles: |offset from the animation| times the limit of that side, a kink at the target (joint_rows.h); or
// all three of a ball joint as one ellipsoid (ellipsoid_row.h).
#pragma once

#include "sinew/effects/joint_step.h"

namespace sinew {

template <class T>
class MuscleRows {
 public:
  static bool act(const JointStep<T>& joint) {
    return joint.any([&](int dof) { return joint.law.has_muscle(dof); });
  }
  explicit MuscleRows(const JointStep<T>& joint);

  void append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const;
  /// Instead of rows, where the joint's limits are an ellipsoid.
  void append(const JointStep<T>& joint, std::vector<EllipsoidRow<T>>& ellipsoids) const;

 private:
  JointOffset<T> from_target_;
};

extern template class MuscleRows<float>;
extern template class MuscleRows<double>;

}  // namespace sinew
