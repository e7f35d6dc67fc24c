#include "sinew/effects/muscle.h"

namespace sinew {

template <class T>
MuscleRows<T>::MuscleRows(const JointStep<T>& joint)
    : from_target_(joint_offset<T>(joint.tree, joint.body, joint.target, joint.local)) {}

template <class T>
void MuscleRows<T>::append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const {
  const int dof = joint.first_dof() + k;
  if (!joint.law.has_muscle(dof)) return;
  JointRow<T>& row = rows.emplace_back(joint.row(from_target_, RowScalar::kFromTarget, k));
  row.minus = joint.law.torque_minus[dof];
  row.plus = joint.law.torque_plus[dof];
  row.width = joint.kink_width;
  row.muscle = true;
}

template <class T>
void MuscleRows<T>::append(const JointStep<T>& joint, std::vector<EllipsoidRow<T>>& ellipsoids) const {
  EllipsoidRow<T>& row = ellipsoids.emplace_back();
  row.dof = joint.first_dof();
  row.gradient = from_target_.rotational;
  row.width = joint.kink_width;
  for (int a = 0; a < 3; ++a) {
    row.value[a] = from_target_.value[a];
    row.minus[a] = joint.law.torque_minus[row.dof + a];
    row.plus[a] = joint.law.torque_plus[row.dof + a];
  }
}

template class MuscleRows<float>;
template class MuscleRows<double>;

}  // namespace sinew
