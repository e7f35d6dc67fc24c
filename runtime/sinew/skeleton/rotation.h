// Rotation vectors: exponential, logarithm and the Jacobians of both.
//
// Source: the standard formulas on SO(3), e.g. Solà, Deray & Atchuthan, "A micro Lie theory for state
// estimation in robotics", 2018, equations (132)–(146). Series below 1e-4 rad (float) where the closed forms
// cancel.
#pragma once

#include <cmath>

#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/scalar.h"
#include "sinew/skeleton/transform.h"

namespace sinew {

/// Matrix of the cross product: skew(a)·b = a × b.
template <class T>
Mat3<T> skew(const Vec3<T>& a) {
  Mat3<T> m;
  m << T(0), -a.z(), a.y(), a.z(), T(0), -a.x(), -a.y(), a.x(), T(0);
  return m;
}

/// Rotation by the vector d (rad). Up to one radian by series, to rounding: no library call, the same bits on
/// every machine.
template <class T>
Quat<T> rotation_exp(const Vec3<T>& d) {
  using portable::cos, portable::sin, std::sqrt;
  using Two = Eigen::Matrix<T, 2, 1>;
  const T angle2 = d.squaredNorm();
  const auto series = [&] {
    const T u = angle2 / 4;
    if constexpr (sizeof(Number<T>) == 4) {
      return Two(
          1 + u * (T(-1.0 / 2) + u * (T(1.0 / 24) + u * (T(-1.0 / 720) + u * T(1.0 / 40320)))),
          T(0.5) + u * (T(-1.0 / 12) + u * (T(1.0 / 240) + u * (T(-1.0 / 10080) + u * T(1.0 / 725760)))));
    } else {
      constexpr double kCosine[] = {1 / 479001600.0, -1 / 3628800.0, 1 / 40320.0, -1 / 720.0,
                                    1 / 24.0,        -1 / 2.0,       1.0};
      constexpr double kSine[] = {1 / 6227020800.0, -1 / 39916800.0, 1 / 362880.0, -1 / 5040.0,
                                  1 / 120.0,        -1 / 6.0,        1.0};
      T cosine = T(-1 / 87178291200.0), sine = T(-1 / 1307674368000.0);  // of the highest powers
      for (int n = 0; n < 7; ++n) {
        cosine = cosine * u + T(kCosine[n]);
        sine = sine * u + T(kSine[n]);
      }
      return Two(cosine, sine / 2);
    }
  };
  const auto closed = [&] {
    const T angle = sqrt(angle2);
    return Two(cos(angle / 2), sin(angle / 2) / angle);
  };
  const Two c = choose(angle2 < T(1), series, closed);  // cos(angle/2), sin(angle/2)/angle
  Quat<T> q(c[0], c[1] * d.x(), c[1] * d.y(), c[1] * d.z());
  renormalize(q);
  return q;
}

/// Rotation vector of q, the shorter way round: |result| ≤ π.
template <class T>
Vec3<T> rotation_log(const Quat<T>& q) {
  using std::abs, portable::atan2;
  const Vec3<T> v = select(q.w() < T(0), Vec3<T>(-q.vec()), Vec3<T>(q.vec()));
  const T sine = v.norm();
  const T cosine = abs(q.w());
  const auto series = [&] {  // 2·asin(sine)/sine to 3e-8 up to a turn of 60 degrees: Cephes, asinf
    const T u = sine * sine;
    return T(
        2 + u * (T(2 * 0.16666752422) + u * (T(2 * 0.074953002686) +
                                             u * (T(2 * 0.045470025998) +
                                                  u * (T(2 * 0.024181311049) + u * T(2 * 0.042163199048))))));
  };
  const auto closed = [&] { return T(T(2) * atan2(sine, cosine) / sine); };
  const auto tiny = [&] { return T(T(2) / largest(cosine, T(0.5))); };
  return v * choose(sine < T(1e-6), tiny, [&] {
           if constexpr (sizeof(Number<T>) == 4)
             return choose(sine < T(0.5), series, closed);
           else
             return closed();
         });
}

/// The shortest rotation that takes the direction of `from` to that of `to`, vectors of any length but zero.
/// Opposite ones are half a turn apart about some axis across them. (Eigen's FromTwoVectors does the same and
/// costs every file that calls it three seconds of compilation for the opposite ones.)
template <class T>
Quat<T> rotation_between(const Vec3<T>& from, const Vec3<T>& to) {
  const Vec3<T> a = from.normalized(), b = to.normalized();
  const T cosine = b.dot(a);
  if (cosine < Eigen::NumTraits<T>::dummy_precision() - T(1)) {
    const Vec3<T> axis = a.unitOrthogonal();
    return Quat<T>(T(0), axis.x(), axis.y(), axis.z());
  }
  const T twice = std::sqrt(2 * (1 + cosine));  // of the cosine of half the angle
  const Vec3<T> axis = a.cross(b) * (1 / twice);
  return Quat<T>(twice / 2, axis.x(), axis.y(), axis.z());
}

/// Right Jacobian: exp(d + δ) ≈ exp(d)·exp(Jr·δ).
template <class T>
Mat3<T> right_jacobian(const Vec3<T>& d) {
  const T a2 = d.squaredNorm();
  T b, c;  // (1 − cos a)/a², (a − sin a)/a³
  if (a2 < T(1e-3)) {
    b = T(0.5) - a2 / 24;
    c = T(1) / 6 - a2 / 120;
  } else {
    const T a = std::sqrt(a2);
    b = (T(1) - portable::cos(a)) / a2;
    c = (a - portable::sin(a)) / (a2 * a);
  }
  const Mat3<T> s = skew(d);
  return Mat3<T>::Identity() - b * s + c * (s * s);
}

/// Inverse of the right Jacobian: log(exp(d)·exp(δ)) ≈ d + Jr⁻¹·δ. Valid for |d| < 2π.
template <class T>
Mat3<T> right_jacobian_inverse(const Vec3<T>& d) {
  using portable::cos, portable::sin, std::sqrt;
  const T a2 = d.squaredNorm();
  const auto series = [&] { return T(T(1) / 12 + a2 / 720); };
  const auto closed = [&] {
    const T a = sqrt(a2);
    return T(T(1) / a2 - cos(a / 2) / (T(2) * a * sin(a / 2)));
  };
  const T c = choose(a2 < T(1e-3), series, closed);  // 1/a² − (1 + cos a)/(2 a sin a)
  const Mat3<T> s = skew(d);
  return Mat3<T>::Identity() + T(0.5) * s + c * (s * s);
}

/// Symmetric M with ½·δᵀMδ the second-order term of λ·log(exp(d)·exp(δ)): how a rotation vector bends away
/// from its own tangent. From dθ/dt = Jr⁻¹(θ)·ω, once more by t.
template <class T>
Mat3<T> log_curvature(const Vec3<T>& d, const Vec3<T>& lambda) {
  using portable::cos, portable::sin, std::sqrt;
  using Two = Eigen::Matrix<T, 2, 1>;
  const T a2 = d.squaredNorm();
  const auto series = [&] { return Two(T(1) / 12 + a2 / 720, T(1) / 360 + a2 / 7560); };
  const auto closed = [&] {
    const T a = sqrt(a2), sine = sin(a / 2), cotangent = cos(a / 2) / sine;
    return Two(T(1) / a2 - cotangent / (T(2) * a),
               (-T(2) / (a2 * a) + cotangent / (T(2) * a2) + T(1) / (T(4) * a * sine * sine)) / a);
  };
  const Two both_factors = choose(a2 < T(1e-2), series, closed);
  const T c = both_factors[0], slope = both_factors[1];  // c of right_jacobian_inverse, and c'(a)/a
  const Mat3<T> s = skew(d), l = skew(lambda);
  const Vec3<T> squared = s * (s * lambda);
  const Mat3<T> bilinear =
      -T(0.5) * l - c * (l * s) - c * skew<T>(lambda.cross(d)) + slope * (d * squared.transpose());
  const Mat3<T> m = right_jacobian_inverse(d).transpose() * bilinear;
  return T(0.5) * (m + m.transpose());
}

/// Angle of the part of q that turns about the unit vector `axis` (swing–twist decomposition), in (−π, π].
template <class T>
T twist_angle(const Quat<T>& q, const Vec3<T>& axis) {
  using portable::atan2;
  const T along = q.vec().dot(axis);
  const T angle = T(2) * atan2(along, q.w());
  constexpr Number<T> pi = Number<T>(3.14159265358979323846);
  return select(angle > T(pi), T(angle - T(2 * pi)), select(angle <= T(-pi), T(angle + T(2 * pi)), angle));
}

/// Angle about the unit vector `axis` by which the part of `to` that turns about it is ahead of that of
/// `from`, in (−π, π].
template <class T>
T twist_between(const Quat<T>& from, const Quat<T>& to, const Vec3<T>& axis) {
  const T sine0 = from.vec().dot(axis), sine1 = to.vec().dot(axis);
  const T cosine = from.w() * to.w() + sine0 * sine1, sine = from.w() * sine1 - to.w() * sine0;
  return twist_angle<T>(Quat<T>(cosine, sine * axis.x(), sine * axis.y(), sine * axis.z()), axis);
}

}  // namespace sinew
