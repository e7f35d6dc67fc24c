#include "sinew/effects/muscle.h"

#include "sinew/optimizer/ellipsoid_rows.h"

namespace sinew {

template <class T>
void Muscles<T>::declare(StepPlan<T>& plan) {
  plan.joints.muscles = &MuscleRows<T>::kTerm;
  plan.ellipsoid_rows = make_ellipsoid_rows<T>;
}

template struct Muscles<float>;
template struct Muscles<double>;

}  // namespace sinew
