// Muscles: |offset from the animation| times the limit of that side, a kink at the target (joint_rows.h); or
// all three of a ball joint as one ellipsoid (ellipsoid_row.h).
#pragma once

#include "sinew/effects/joint_step.h"

namespace sinew {

template <class T, class Law = JointLaw<T>>
class MuscleRows {
 public:
  using Step = JointStep<T, Law>;

  static bool act(const Step& joint) {
    return joint.any_dof([&](int dof) { return joint.law.has_muscle(dof); });
  }
  explicit MuscleRows(const Step& joint)
      : from_target_(offset_of<T>(joint.tree, joint.body, joint.target, joint.local)) {}

  template <class Rows>
  void append(const Step& joint, int k, Rows& rows) const {
    const int dof = joint.first_dof() + k;
    const auto pulls = joint.law.has_muscle(dof);
    if (!any(pulls)) return;
    JointRow<T> row = joint.row(from_target_, RowScalar::kFromTarget, k);
    row.minus = joint.law.torque_minus[dof];
    row.plus = joint.law.torque_plus[dof];
    row.width = joint.kink_width;
    row.muscle = true;
    rows.add_row(row, pulls);
  }
  /// Instead of rows, where the joint's limits are an ellipsoid.
  void append(const Step& joint, std::vector<EllipsoidRow<T>>& ellipsoids) const;

 private:
  JointOffset<T> from_target_;
};

extern template class MuscleRows<float>;
extern template class MuscleRows<double>;

}  // namespace sinew
