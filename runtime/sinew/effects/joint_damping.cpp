#include "sinew/effects/joint_damping.h"

namespace sinew {

template <class T>
JointDampingRows<T>::JointDampingRows(const JointStep<T>& joint)
    : from_start_(joint_offset<T>(joint.tree, joint.body, joint.start, joint.local)) {}

template <class T>
void JointDampingRows<T>::append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const {
  const int dof = joint.first_dof() + k;
  if (const T friction = joint.law.dry_friction[dof]; friction > T(0)) {
    JointRow<T>& row = rows.emplace_back(joint.row(from_start_, RowScalar::kFromStart, k));
    row.minus = row.plus = friction;
    row.width = 10 * joint.kink_width;
  }
  if (const T damping = joint.law.damping[dof]; damping > T(0)) {
    JointRow<T>& row = rows.emplace_back(joint.row(from_start_, RowScalar::kFromStart, k));
    row.kind = RowKind::kSpring;
    row.stiffness = damping / joint.h;
  }
}

template class JointDampingRows<float>;
template class JointDampingRows<double>;

}  // namespace sinew
