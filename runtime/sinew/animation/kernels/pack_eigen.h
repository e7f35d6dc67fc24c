// Packs as the scalar of Eigen's small vectors, matrices and quaternions. Kernel translation units only, as
// pack.h: what Eigen makes of a pack has internal linkage too.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

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

namespace internal {

/// In the order in which Eigen multiplies quaternions of floats on x86: packs have the bits of scalars.
template <class A, class B, class T, int N>
struct quat_product<Architecture::Target, A, B, sinew::Pack<T, N>> {
  static Quaternion<sinew::Pack<T, N>> run(const QuaternionBase<A>& a, const QuaternionBase<B>& b) {
    return {(a.w() * b.w() - a.x() * b.x()) - (a.z() * b.z() + a.y() * b.y()),
            (a.x() * b.w() - a.z() * b.y()) + (a.y() * b.z() + a.w() * b.x()),
            (a.y() * b.w() - a.x() * b.z()) + (a.z() * b.x() + a.w() * b.y()),
            (a.z() * b.w() - a.y() * b.x()) + (a.x() * b.y() + a.w() * b.z())};
  }
};

}  // namespace internal
}  // namespace Eigen

namespace sinew {
namespace {

/// See scalar.h; sums in the order in which Eigen adds nine floats on x86.
template <class P>
requires(!std::is_arithmetic_v<P>) P sum_of_products(const Mat3<P>& a, const Mat3<P>& b) {
  const Mat3<P> m = a.cwiseProduct(b);
  return (((m(0) + m(4)) + (m(2) + m(6))) + ((m(1) + m(5)) + (m(3) + m(7)))) + m(8);
}

}  // namespace
}  // namespace sinew
