// Uniform B-spline basis: value, first and second derivative of the functions that reach one knot span.
#pragma once

#include <array>

namespace sinew {

/// Weights of the `degree` + 1 control points of a span at its local parameter u in [0, 1].
/// Derivatives are per knot interval: divide by the interval once and twice.
template <class T>
struct BsplineBasis {
  std::array<T, 6> value{}, first{}, second{};

  /// Cox–de Boor on uniform knots: N_j^d = ((u − j + d) N_{j−1}^{d−1} + (j + 1 − u) N_j^{d−1}) / d, and the
  /// derivative of N_j^d is N_{j−1}^{d−1} − N_j^{d−1}.
  static BsplineBasis at(int degree, T u) {
    BsplineBasis basis;
    std::array<T, 6> below{}, lower{}, now{};
    now[0] = T(1);
    for (int d = 1; d <= degree; ++d) {
      below = lower;
      lower = now;
      for (int j = d; j >= 0; --j) {
        const T left = j > 0 ? (u - T(j) + T(d)) * lower[j - 1] : T(0);
        const T right = j < d ? (T(j + 1) - u) * lower[j] : T(0);
        now[j] = (left + right) / T(d);
      }
    }
    const auto entry = [](const std::array<T, 6>& w, int j, int count) {
      return j >= 0 && j < count ? w[j] : T(0);
    };
    for (int j = 0; j <= degree; ++j) {
      basis.value[j] = now[j];
      basis.first[j] = entry(lower, j - 1, degree) - entry(lower, j, degree);
      basis.second[j] =
          entry(below, j - 2, degree - 1) - 2 * entry(below, j - 1, degree - 1) + entry(below, j, degree - 1);
    }
    return basis;
  }
};

}  // namespace sinew
