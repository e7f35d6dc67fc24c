// Muscles: |offset from the animation| times the limit of that side, a kink at the target (joint_rows.h); or
// all three of a ball joint as one ellipsoid (ellipsoid_row.h). With a tone (tone.h) the kink is a spring up
// to that limit, about where the muscle does nothing.
#pragma once

#include "sinew/effects/joint_step.h"
#include "sinew/effects/step_plan.h"

namespace sinew {

/// The rows of one joint's muscles, of one character or of a lane of them.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct MuscleRows {
  using Step = JointStep<T, Law>;  ///< a joint as the step has it now

  /// Whether it has muscles of its single degrees of freedom; its offset from the target then. An ellipsoid
  /// is added here.
  static bool look(const Step& joint, JointOffset<T>& from_target, Rows& rows) {
    if (!joint.any_dof([&](int dof) { return joint.law.has_muscle(dof); })) return false;
    from_target = offset_of<T>(joint.tree, joint.body, joint.target, joint.local);
    if constexpr (std::is_arithmetic_v<T>)
      if (joint.law.ellipsoidal[joint.body]) {
        rows.ellipsoids.push_back(ellipsoid(joint, from_target));
        return false;
      }
    return true;
  }
  /// Adds the row of its k-th degree of freedom.
  static void append(const Step& joint, const JointOffset<T>& from_target, int k, Rows& rows) {
    const int dof = joint.first_dof() + k;
    const auto pulls = joint.law.has_muscle(dof);
    if (!any(pulls)) return;
    JointRow<T> row = joint.row(from_target, RowScalar::kFromTarget, k);
    row.minus = joint.emphasis * joint.law.torque_minus[dof];
    row.plus = joint.emphasis * joint.law.torque_plus[dof];
    row.width = joint.kink_width * joint.unit(k);
    row.muscle = true;
    if (joint.law.has_tone(dof)) {
      const auto& tone = joint.law.tone[dof];
      row.kind = RowKind::kTone;
      row.stiffness = joint.emphasis * tone.slope;
      row.value -= tone.neutral;
    }
    rows.add_row(row, pulls);
  }
  static constexpr JointTerm<T, Law, Rows> kTerm{look, append};  ///< as a plan holds it

 private:
  static EllipsoidRow<T> ellipsoid(const Step& joint, const JointOffset<T>& from_target) {
    EllipsoidRow<T> row;
    row.dof = joint.first_dof();
    row.gradient = from_target.rotational;
    row.width = joint.kink_width;
    for (int a = 0; a < 3; ++a) {
      row.value[a] = from_target.value[a];
      row.minus[a] = joint.emphasis * joint.law.torque_minus[row.dof + a];
      row.plus[a] = joint.emphasis * joint.law.torque_plus[row.dof + a];
    }
    if (joint.law.has_tone(row.dof)) give_tone(joint, row);
    return row;
  }
  /// See ToneOfDof::slope: of an ellipsoid as the square of the longer half axis along each.
  static void give_tone(const Step& joint, EllipsoidRow<T>& row) {
    const T longest = std::max(row.minus.maxCoeff(), row.plus.maxCoeff());
    for (int a = 0; a < 3; ++a) {
      const auto& tone = joint.law.tone[row.dof + a];
      row.value[a] -= tone.neutral;
      const T half_axis = std::max(row.minus[a], row.plus[a]);
      if (half_axis == longest) row.width = longest / (joint.emphasis * tone.slope);
    }
  }
};

/// What World::declare takes. Without, strengths are 0 (limp) or infinite (the animation is played whatever
/// it takes).
template <class T>
struct Muscles {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct Muscles<float>;
extern template struct Muscles<double>;

}  // namespace sinew
