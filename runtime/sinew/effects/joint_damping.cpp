#include "sinew/effects/joint_damping.h"

namespace sinew {

template class JointDampingRows<float>;
template class JointDampingRows<double>;

}  // namespace sinew
