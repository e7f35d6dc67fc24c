#include "sinew/effects/joint_limit.h"

namespace sinew {

template class JointLimitRows<float>;
template class JointLimitRows<double>;

}  // namespace sinew
