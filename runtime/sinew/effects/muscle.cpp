#include "sinew/effects/muscle.h"

namespace sinew {

template <class T, class Law>
void MuscleRows<T, Law>::append(const Step& joint, std::vector<EllipsoidRow<T>>& ellipsoids) const {
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
