// Uniform B-spline basis: value, first and second derivative of the functions that reach one knot span.
#pragma once

#include <array>

#include "sinew/skeleton/scalar.h"

namespace sinew {
namespace detail {

template <class T>
struct BsplineMonomials;

}  // namespace detail

/// Weights of the `degree` + 1 control points of a span at its local parameter u in [0, 1]; entries beyond
/// are zero. Derivatives are per knot interval: divide by the interval once and twice. T may be a pack.
template <class T>
struct BsplineBasis {
  static constexpr int kMaxDegree = 5;
  std::array<T, kMaxDegree + 1> value{}, first{}, second{};

  static BsplineBasis at(int degree, T u);
  /// The same with the caller's monomials of that degree.
  static BsplineBasis of(const detail::BsplineMonomials<Number<T>>& monomials, int degree, T u);
};

namespace detail {

/// Coefficients [power][control point] of the basis of one degree, as polynomials in u.
template <class T>
struct BsplineMonomials {
  static constexpr int kPowers = 6, kControls = 8;  ///< controls padded to whole SIMD registers
  T coefficient[kPowers][kControls] = {};

  /// Cox–de Boor on uniform knots: N_j^d = ((u − j + d) N_{j−1}^{d−1} + (j + 1 − u) N_j^{d−1}) / d.
  constexpr explicit BsplineMonomials(int degree) {
    double exact[kPowers][kControls] = {{1}};
    for (int d = 1; d <= degree; ++d)
      for (int j = d; j >= 0; --j) {  // downwards: N_{j−1}^{d−1} is still in place
        double next[kPowers] = {};
        for (int k = 0; k < d; ++k) {
          const double left = j > 0 ? exact[k][j - 1] : 0, right = j < d ? exact[k][j] : 0;
          next[k] += ((d - j) * left + (j + 1) * right) / d;
          next[k + 1] += (left - right) / d;
        }
        for (int k = 0; k <= d; ++k) exact[k][j] = next[k];
      }
    for (int k = 0; k < kPowers; ++k)
      for (int j = 0; j < kControls; ++j) coefficient[k][j] = T(exact[k][j]);
  }
};
template <class T>
inline constexpr BsplineMonomials<T> kBsplineMonomials[] = {BsplineMonomials<T>(0), BsplineMonomials<T>(1),
                                                            BsplineMonomials<T>(2), BsplineMonomials<T>(3),
                                                            BsplineMonomials<T>(4), BsplineMonomials<T>(5)};

}  // namespace detail

template <class T>
BsplineBasis<T> BsplineBasis<T>::at(int degree, T u) {
  return of(detail::kBsplineMonomials<T>[degree], degree, u);
}

/// Horner's rule on all control points at once, with both derivatives.
template <class T>
BsplineBasis<T> BsplineBasis<T>::of(const detail::BsplineMonomials<Number<T>>& monomials, int degree, T u) {
  using Monomials = detail::BsplineMonomials<Number<T>>;
  T value[Monomials::kControls] = {}, first[Monomials::kControls] = {},
    half_second[Monomials::kControls] = {};
  for (int k = degree; k >= 0; --k)
    for (int j = 0; j < Monomials::kControls; ++j) {
      half_second[j] = half_second[j] * u + first[j];
      first[j] = first[j] * u + value[j];
      value[j] = value[j] * u + T(monomials.coefficient[k][j]);
    }
  BsplineBasis basis;
  for (int j = 0; j <= kMaxDegree; ++j) {
    basis.value[j] = value[j];
    basis.first[j] = first[j];
    basis.second[j] = 2 * half_second[j];
  }
  return basis;
}

}  // namespace sinew
