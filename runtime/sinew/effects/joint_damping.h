// What a skeleton's joints lose: dry friction, a kink at where the step began, and viscous damping, the
// potential c/(2h)·s² of the way s since then.
#pragma once

#include "sinew/effects/joint_step.h"
#include "sinew/effects/step_plan.h"

namespace sinew {

/// The rows of one joint's losses, of one character or of a lane of them.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct JointDampingRows {
  using Step = JointStep<T, Law>;  ///< a joint as the step has it now

  /// Whether the joint loses anything; its offset from where the step began then.
  static bool look(const Step& joint, JointOffset<T>& from_start, Rows& /*rows*/) {
    const Law& law = joint.law;
    if (!joint.any_dof([&](int dof) { return law.dry_friction[dof] > 0 || law.damping[dof] > 0; }))
      return false;
    from_start = offset_of<T>(joint.tree, joint.body, joint.start, joint.local);
    return true;
  }
  /// Adds the rows of its k-th degree of freedom.
  static void append(const Step& joint, const JointOffset<T>& from_start, int k, Rows& rows) {
    const int dof = joint.first_dof() + k;
    const auto always = T(0) <= T(0);
    if (const Number<T> friction = joint.law.dry_friction[dof]; friction > 0) {
      JointRow<T> row = joint.row(from_start, RowScalar::kFromStart, k);
      row.minus = row.plus = joint.emphasis * friction;
      row.width = 10 * joint.kink_width * joint.unit(k);
      rows.add_row(row, always);
    }
    if (const Number<T> damping = joint.law.damping[dof]; damping > 0) {
      JointRow<T> row = joint.row(from_start, RowScalar::kFromStart, k);
      row.kind = RowKind::kSpring;
      row.stiffness = joint.emphasis * damping / joint.h;
      rows.add_row(row, always);
    }
  }
  static constexpr JointTerm<T, Law, Rows> kTerm{look, append};  ///< as a plan holds it
};

/// What World::declare takes. Without, the skeleton's friction and damping do nothing.
template <class T>
struct JointDamping {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct JointDamping<float>;
extern template struct JointDamping<double>;

}  // namespace sinew
