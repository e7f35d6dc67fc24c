// What templates ask of their scalar beyond arithmetic, so that float, double and packs of them (pack.h) run
// through the same source: decisions on values are selections, never branches, where lanes may differ.
#pragma once

#include <cmath>
#include <type_traits>

#include "sinew/skeleton/vector.h"

namespace sinew {

/// The number that a scalar is made of: T itself, or what the lanes of a pack hold. Constants that all lanes
/// share are of this type.
template <class T>
struct NumberOf {
  using Type = T;  ///< of a scalar itself; packs specialise
};
/// NumberOf, in short.
template <class T>
using Number = typename NumberOf<T>::Type;

/// `yes` where the mask is set. A scalar's mask is a bool; packs bring their own overloads.
template <class T>
T select(bool mask, const T& yes, const T& no) {
  return mask ? yes : no;
}
/// Of two masks, lane by lane: a ∧ b.
inline bool both(bool a, bool b) {
  return a && b;
}
/// a ∨ b.
inline bool either(bool a, bool b) {
  return a || b;
}
/// Whether the mask of any lane is set.
inline bool any(bool mask) {
  return mask;
}
/// One mask for all elements of a matrix.
template <class Mask, class T, int R, int C>
requires(!std::is_same_v<Mask, bool>) Eigen::Matrix<T, R, C> select(const Mask& mask,
                                                                    const Eigen::Matrix<T, R, C>& yes,
                                                                    const Eigen::Matrix<T, R, C>& no) {
  Eigen::Matrix<T, R, C> out;
  for (int i = 0; i < R * C; ++i) out(i) = select(mask, yes(i), no(i));
  return out;
}

/// yes() where the mask is set, else no(). What no lane needs is not evaluated: for a scalar this is a
/// branch.
template <class Mask, class Yes, class No>
[[gnu::always_inline]] inline auto choose(const Mask& mask, const Yes& yes, const No& no) {
  if (!any(!mask)) return yes();
  if (!any(mask)) return no();
  return select(mask, yes(), no());
}

/// As std::max, lane by lane: `a` where one is NaN.
template <class T>
T largest(const T& a, const T& b) {
  return select(a < b, b, a);
}
/// As std::min, likewise.
template <class T>
T smallest(const T& a, const T& b) {
  return select(b < a, b, a);
}

/// To double precision: energies are summed in it.
inline double widened(float x) {
  return double(x);
}
/// As it is.
inline double widened(double x) {
  return x;
}

/// Where it is neither infinite nor NaN.
template <class T>
auto finite(const T& x) {
  return x - x == T(0);
}

/// tr(a bᵀ).
template <class T>
requires std::is_arithmetic_v<T> T sum_of_products(const Mat3<T>& a, const Mat3<T>& b) {
  return a.cwiseProduct(b).sum();
}

/// |q|².
template <class T>
T square(const Quat<T>& q) {
  return (q.x() * q.x() + q.z() * q.z()) + (q.y() * q.y() + q.w() * q.w());
}

/// To length 1; 0 becomes NaN.
template <class T>
void normalize(Quat<T>& q) {
  using std::sqrt;
  q.coeffs() *= T(1) / sqrt(square(q));
}

/// The same for what is one but for rounding: a step of Newton's method for 1/|q| from 1. Where it is done
/// again and again, lengths stay a little short.
template <class T>
void renormalize(Quat<T>& q) {
  q.coeffs() *= T(1.5) - T(0.5) * square(q);
}

}  // namespace sinew
