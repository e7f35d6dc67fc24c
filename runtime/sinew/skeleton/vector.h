// Vectors, matrices and rotations, templated on the scalar: Eigen's types, with arithmetic of our own between
// vectors and matrices of three. C++17 suffices for this header and joint_type.h: tools that must be compiled
// so can include them.
//
// Eigen's operators build an expression type for every formula, which the compiler instantiates and then
// flattens again. In three dimensions that buys nothing. The operators below return values. Within namespace
// sinew they are preferred where both operands are plain, and halve what the dearest files cost to compile;
// results are Eigen's, in float to the bit (tests/skeleton/vector_test.cpp). Whatever else Eigen offers works
// as before, and code outside of the namespace sees Eigen alone.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <type_traits>

namespace sinew {

/// A column.
template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
/// Column-major.
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
/// Stored x y z w; its constructor takes w x y z. Products of rotations: the right one first.
template <class T>
using Quat = Eigen::Quaternion<T>;

namespace vector {

/// Whether S may scale what is made of T: T itself, an integer or, where T is a pack, what its lanes hold.
template <class S, class T>
inline constexpr bool kScales = std::is_same_v<S, T> || std::is_integral_v<S> ||
                                (!std::is_arithmetic_v<T> && std::is_floating_point_v<S>);

/// Result of an operator that S may take part in: M.
template <class S, class T, class M>
using Scaled = std::enable_if_t<kScales<S, T>, M>;

/// Result of an operator on the transpose of A, which is a Mat3<T> or a constant one: M.
template <class A, class T, class M>
using Transposed = std::enable_if_t<std::is_same_v<std::remove_const_t<A>, Mat3<T>>, M>;

/// In the order in which Eigen sums three terms in float.
template <class T>
[[gnu::always_inline]] inline T sum(const T& a, const T& b, const T& c) {
  return a + (b + c);
}

/// Element by element.
template <class T, class F>
[[gnu::always_inline]] inline Vec3<T> each(const Vec3<T>& a, const F& f) {
  return Vec3<T>(f(a.x(), 0), f(a.y(), 1), f(a.z(), 2));
}

/// Product of two matrices that are read through row(i, k) and column(k, j).
template <class T, class Left, class Right>
[[gnu::always_inline]] inline Mat3<T> product(const Left& left, const Right& right) {
  Mat3<T> out;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      out(i, j) = sum<T>(left(i, 0) * right(0, j), left(i, 1) * right(1, j), left(i, 2) * right(2, j));
  return out;
}

}  // namespace vector

// Each is Eigen's operator of its name: pages leave them out.
/// @cond

template <class T>
[[gnu::always_inline]] inline Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return vector::each<T>(a, [&](const T& x, int k) { return T(x + b.data()[k]); });
}
template <class T>
[[gnu::always_inline]] inline Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return vector::each<T>(a, [&](const T& x, int k) { return T(x - b.data()[k]); });
}
template <class T>
[[gnu::always_inline]] inline Vec3<T> operator-(const Vec3<T>& a) {
  return vector::each<T>(a, [](const T& x, int) { return T(-x); });
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Vec3<T>> operator*(const Vec3<T>& a, const S& s) {
  return vector::each<T>(a, [by = T(s)](const T& x, int) { return T(x * by); });
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Vec3<T>> operator*(const S& s, const Vec3<T>& a) {
  return vector::each<T>(a, [by = T(s)](const T& x, int) { return T(by * x); });
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Vec3<T>> operator/(const Vec3<T>& a, const S& s) {
  return vector::each<T>(a, [by = T(s)](const T& x, int) { return T(x / by); });
}
// Element by element, Eigen's own: it adds four numbers at a time.
template <class T>
[[gnu::always_inline]] inline Mat3<T> operator+(const Mat3<T>& a, const Mat3<T>& b) {
  return a.operator+(b);
}
template <class T>
[[gnu::always_inline]] inline Mat3<T> operator-(const Mat3<T>& a, const Mat3<T>& b) {
  return a.operator-(b);
}
template <class T>
[[gnu::always_inline]] inline Mat3<T> operator-(const Mat3<T>& a) {
  return a.operator-();
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Mat3<T>> operator*(const Mat3<T>& a, const S& s) {
  return a.operator*(T(s));
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Mat3<T>> operator*(const S& s, const Mat3<T>& a) {
  return a.operator*(T(s));
}
template <class T, class S>
[[gnu::always_inline]] inline vector::Scaled<S, T, Mat3<T>> operator/(const Mat3<T>& a, const S& s) {
  return a.operator/(T(s));
}

template <class T>
[[gnu::always_inline]] inline Vec3<T> operator*(const Mat3<T>& m, const Vec3<T>& v) {
  const auto row = [&](int i) { return vector::sum<T>(m(i, 0) * v[0], m(i, 1) * v[1], m(i, 2) * v[2]); };
  return Vec3<T>(row(0), row(1), row(2));
}
template <class A, class T>
[[gnu::always_inline]] inline vector::Transposed<A, T, Vec3<T>> operator*(const Eigen::Transpose<A>& m,
                                                                          const Vec3<T>& v) {
  const Mat3<T>& a = m.nestedExpression();
  const auto row = [&](int i) { return vector::sum<T>(a(0, i) * v[0], a(1, i) * v[1], a(2, i) * v[2]); };
  return Vec3<T>(row(0), row(1), row(2));
}
template <class T>
[[gnu::always_inline]] inline Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  return vector::product<T>(a, b);
}
template <class A, class T>
[[gnu::always_inline]] inline vector::Transposed<A, T, Mat3<T>> operator*(const Eigen::Transpose<A>& a,
                                                                          const Mat3<T>& b) {
  const Mat3<T>& own = a.nestedExpression();
  return vector::product<T>([&](int i, int k) -> const T& { return own(k, i); }, b);
}
template <class A, class T>
[[gnu::always_inline]] inline vector::Transposed<A, T, Mat3<T>> operator*(const Mat3<T>& a,
                                                                          const Eigen::Transpose<A>& b) {
  const Mat3<T>& own = b.nestedExpression();
  return vector::product<T>(a, [&](int k, int j) -> const T& { return own(j, k); });
}
/// @endcond

}  // namespace sinew
