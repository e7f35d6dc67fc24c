#include "sinew/effects/ground_balance.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

template <class T>
using Vec6 = Eigen::Matrix<T, 6, 1>;
template <class T>
using Mat6 = Eigen::Matrix<T, 6, 6>;

constexpr double kYield = 1e-5;   ///< ε, in units of the weight: a thousandth of what helps is left at most
constexpr double kEnough = 2e-4;  ///< of the weight (times the unit), that a balance may miss
constexpr int kShortenings = 16;  ///< halvings of a Newton step
constexpr double kDecrease = 1e-4;  ///< Armijo's

/// The point of a friction cone (normal `n`, coefficient `mu`) that is closest to a force, and the
/// projection's derivative, symmetric.
template <class T>
Vec3<T> into_cone(const Vec3<T>& force, const Vec3<T>& n, T mu, Mat3<T>& derivative) {
  const T z = n.dot(force);
  const Vec3<T> along = force - z * n;
  const T s = along.norm();
  derivative.setZero();
  if (s <= mu * z) {
    derivative.setIdentity();
    return force;
  }
  if (mu * s <= -z) return Vec3<T>::Zero();
  const Vec3<T> way = along / s, ray = (n + mu * way) / std::sqrt(1 + mu * mu);
  const T size = ray.dot(force), out = mu * size / (std::sqrt(1 + mu * mu) * s);
  derivative =
      ray * ray.transpose() + out * (Mat3<T>::Identity() - n * n.transpose() - way * way.transpose());
  return size * ray;
}

/// The dual in units of the weight and the unit of length, moments about `middle`.
template <class T>
struct Dual {
  std::span<const BearingPoint<T>> points;
  Vec3<T> middle = Vec3<T>::Zero();
  Vec6<T> wanted = Vec6<T>::Zero();
  T weight, unit, total = T(0);  ///< `total`: of the shares

  T may_bear(const BearingPoint<T>& p) const { return p.share / total; }
  Vec3<T> arm(const BearingPoint<T>& p) const { return (p.place - middle) / unit; }
  /// What a point bears at y, before its cone.
  Vec3<T> asked(const BearingPoint<T>& p, const Vec6<T>& y) const {
    return p.force / weight +
           may_bear(p) * (y.template head<3>() + Vec3<T>(y.template tail<3>()).cross(arm(p)));
  }
  T value(const Vec6<T>& y) const {
    T sum = T(kYield) / 2 * y.squaredNorm() - wanted.dot(y);
    Mat3<T> unused;
    for (const BearingPoint<T>& p : points)
      sum += into_cone<T>(asked(p, y), p.normal, p.friction, unused).squaredNorm() / (2 * may_bear(p));
    return sum;
  }
  Vec6<T> slope(const Vec6<T>& y, Mat6<T>& matrix) const {
    Vec6<T> sum = T(kYield) * y - wanted;
    matrix = T(kYield) * Mat6<T>::Identity();
    for (const BearingPoint<T>& p : points) {
      Mat3<T> gives;
      const Vec3<T> force = into_cone<T>(asked(p, y), p.normal, p.friction, gives), at = arm(p);
      sum.template head<3>() += force;
      sum.template tail<3>() += at.cross(force);
      gives *= may_bear(p);
      const Mat3<T> lever = skew<T>(at), turned = lever * gives;
      matrix.template topLeftCorner<3, 3>() += gives;
      matrix.template bottomLeftCorner<3, 3>() += turned;
      matrix.template bottomRightCorner<3, 3>() += turned * lever.transpose();
    }
    return sum;
  }
};

}  // namespace

template <class T>
int balance_ground(std::span<BearingPoint<T>> points, const Vec3<T>& force, const Vec3<T>& moment, T weight,
                   T unit) {
  Dual<T> dual{.points = points, .weight = weight, .unit = unit};
  for (const BearingPoint<T>& p : points) {
    dual.total += p.share;
    dual.middle += p.share * p.place;
  }
  if (!(dual.total > T(0))) return 0;
  dual.middle /= dual.total;
  dual.wanted.template head<3>() = force / weight;
  dual.wanted.template tail<3>() = Vec3<T>(moment - dual.middle.cross(force)) / (weight * unit);
  Vec6<T> y = Vec6<T>::Zero();
  Mat6<T> matrix;
  int steps = 0;
  for (Vec6<T> slope = dual.slope(y, matrix); steps < kBalanceSteps && slope.norm() > T(kEnough); ++steps) {
    const Vec6<T> step = -matrix.template selfadjointView<Eigen::Lower>().llt().solve(slope);
    const T now = dual.value(y), fall = slope.dot(step);
    T share = T(1);
    for (int n = 0; n < kShortenings && dual.value(y + share * step) > now + T(kDecrease) * share * fall; ++n)
      share /= 2;
    y += share * step;
    slope = dual.slope(y, matrix);
  }
  Mat3<T> unused;
  for (BearingPoint<T>& p : points)
    p.force = weight * into_cone<T>(dual.asked(p, y), p.normal, p.friction, unused);
  return steps;
}

template int balance_ground<float>(std::span<BearingPoint<float>>, const Vec3<float>&, const Vec3<float>&,
                                   float, float);
template int balance_ground<double>(std::span<BearingPoint<double>>, const Vec3<double>&, const Vec3<double>&,
                                    double, double);

}  // namespace sinew
