#include "sinew/animation/crossfade.h"

#include <cmath>

namespace sinew {
namespace {

template <class T>
using Vec4 = Eigen::Matrix<T, 4, 1>;

/// Quaternion with its time derivatives, coefficients x y z w.
template <class T>
struct QuaternionJet {
  Vec4<T> p, dp, ddp;
};

/// q' = ½ q ω, q'' = ½ q (α − ½|ω|²), ω and α in child axes.
template <class T>
QuaternionJet<T> quaternion_jet(const JointJet<T>& jet) {
  const Quat<T>& q = jet.rotation;
  const auto times = [&](const Vec3<T>& v, T real) {
    return Vec4<T>((q * Quat<T>(real, v.x(), v.y(), v.z())).coeffs());
  };
  return {q.coeffs(), T(0.5) * times(jet.omega, T(0)),
          T(0.5) * times(jet.alpha, T(-0.5) * jet.omega.squaredNorm())};
}

}  // namespace

template <class T>
void crossfade(std::span<const JointJet<T>> a, std::span<const JointJet<T>> b, const EaseWeight<T>& w,
               std::span<JointJet<T>> out) {
  const T rest = T(1) - w.value;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const QuaternionJet<T> qa = quaternion_jet(a[i]);
    QuaternionJet<T> qb = quaternion_jet(b[i]);
    const T sign = qa.p.dot(qb.p) < T(0) ? T(-1) : T(1);
    const Vec4<T> apart = sign * qb.p - qa.p, apart_rate = sign * qb.dp - qa.dp;
    const Vec4<T> p = qa.p + w.value * apart;
    const Vec4<T> dp = rest * qa.dp + w.value * sign * qb.dp + w.rate * apart;
    const Vec4<T> ddp =
        rest * qa.ddp + w.value * sign * qb.ddp + 2 * w.rate * apart_rate + w.acceleration * apart;
    const T inverse = T(1) / p.squaredNorm();
    const auto twice_imaginary = [&](const Vec4<T>& d) {
      const Vec3<T> v = p.template head<3>(), u = d.template head<3>();
      return Vec3<T>((T(2) * inverse) * (p[3] * u - d[3] * v - v.cross(u)));
    };
    JointJet<T> jet;
    jet.rotation.coeffs() = p * std::sqrt(inverse);
    jet.omega = twice_imaginary(dp);
    jet.alpha = twice_imaginary(ddp) - jet.omega * (T(2) * inverse * p.dot(dp));
    const Vec3<T> shift = b[i].translation - a[i].translation, shift_rate = b[i].velocity - a[i].velocity;
    jet.translation = a[i].translation + w.value * shift;
    jet.velocity = a[i].velocity + w.value * shift_rate + w.rate * shift;
    jet.acceleration = rest * a[i].acceleration + w.value * b[i].acceleration + 2 * w.rate * shift_rate +
                       w.acceleration * shift;
    out[i] = jet;
  }
}

template void crossfade<float>(std::span<const JointJet<float>>, std::span<const JointJet<float>>,
                               const EaseWeight<float>&, std::span<JointJet<float>>);
template void crossfade<double>(std::span<const JointJet<double>>, std::span<const JointJet<double>>,
                                const EaseWeight<double>&, std::span<JointJet<double>>);

}  // namespace sinew
