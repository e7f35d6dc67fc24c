// What a skeleton's joints lose: dry friction, a kink at where the step began, and viscous damping, the
// potential c/(2h)·s² of the way s since then.
#pragma once

#include "sinew/effects/joint_step.h"

namespace sinew {

template <class T, class Law = JointLaw<T>>
class JointDampingRows {
 public:
  using Step = JointStep<T, Law>;

  static bool act(const Step& joint) {
    const Law& law = joint.law;
    return joint.any_dof([&](int dof) { return law.dry_friction[dof] > 0 || law.damping[dof] > 0; });
  }
  explicit JointDampingRows(const Step& joint)
      : from_start_(offset_of<T>(joint.tree, joint.body, joint.start, joint.local)) {}

  template <class Rows>
  void append(const Step& joint, int k, Rows& rows) const {
    const int dof = joint.first_dof() + k;
    const auto always = T(0) <= T(0);
    if (const Number<T> friction = joint.law.dry_friction[dof]; friction > 0) {
      JointRow<T> row = joint.row(from_start_, RowScalar::kFromStart, k);
      row.minus = row.plus = friction;
      row.width = 10 * joint.kink_width;
      rows.add_row(row, always);
    }
    if (const Number<T> damping = joint.law.damping[dof]; damping > 0) {
      JointRow<T> row = joint.row(from_start_, RowScalar::kFromStart, k);
      row.kind = RowKind::kSpring;
      row.stiffness = damping / joint.h;
      rows.add_row(row, always);
    }
  }

 private:
  JointOffset<T> from_start_;
};

extern template class JointDampingRows<float>;
extern template class JointDampingRows<double>;

}  // namespace sinew
