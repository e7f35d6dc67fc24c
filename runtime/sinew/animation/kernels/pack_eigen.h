// Packs as the scalar of Eigen's small vectors, matrices and quaternions. Kernel translation units only, as
// pack.h: what Eigen makes of a pack has internal linkage too.
#pragma once

#include <Eigen/Core>

#include "sinew/animation/kernels/pack.h"

namespace Eigen {

template <class T, int N>
struct NumTraits<sinew::Pack<T, N>> : GenericNumTraits<T> {
  using Real = sinew::Pack<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { RequireInitialization = 0 };
};

}  // namespace Eigen
