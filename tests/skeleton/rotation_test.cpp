// Closed forms on rotations against differences and series limits.
#include "sinew/skeleton/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sinew/skeleton/principal_axes.h"

namespace sinew {
namespace {

using V = Vec3<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr unsigned kSeed = 11;

/// Random directions at the lengths where formulas change: series, switch-over, middle, near π.
std::vector<V> vectors(double longest) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::vector<V> out;
  for (const double length : {0.0, 1e-9, 1e-4, 9.9e-4, 1.1e-3, 0.03, 0.032, 0.5, 1.5, 3.1, 4.0, 6.0}) {
    if (length > longest) break;
    for (int n = 0; n < 4; ++n)
      out.emplace_back(V(normal(random), normal(random), normal(random)).normalized() * length);
  }
  return out;
}

TEST(Rotation, SkewIsTheCrossProduct) {
  const V a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Rotation, ExponentialAgreesWithAngleAxis) {
  for (const V& d : vectors(6.0)) {
    const double angle = d.norm();
    const V axis = angle > 0 ? V(d / angle) : V(V::UnitX());
    const Mat3<double> expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    // The series end at a⁴/1920 of a switch-over at a = 1e-3: below 1e-15.
    EXPECT_LT((rotation_exp(d).toRotationMatrix() - expected).norm(), 1e-14) << d.transpose();
  }
}

TEST(Rotation, LogarithmInvertsExponentialUpToPi) {
  for (const V& d : vectors(3.1)) {
    const Quat<double> q = rotation_exp(d);
    EXPECT_LT((rotation_log(q) - d).norm(), 1e-12) << d.transpose();
    const Quat<double> negated(-q.w(), -q.x(), -q.y(), -q.z());  // same rotation, other sign
    EXPECT_LT((rotation_log(negated) - d).norm(), 1e-12) << d.transpose();
  }
}

TEST(Rotation, LogarithmTakesTheShorterWay) {
  for (const V& d : vectors(6.0)) EXPECT_LE(rotation_log(rotation_exp(d)).norm(), kPi + 1e-12);
}

TEST(Rotation, RightJacobianIsTheDerivativeOfExponential) {
  constexpr double step = 1e-5;  // central difference: error of order step² = 1e-10
  for (const V& d : vectors(6.0)) {
    const Mat3<double> jacobian = right_jacobian(d);
    for (int a = 0; a < 3; ++a) {
      const V e = V::Unit(a) * step;
      const V ahead = rotation_log<double>(rotation_exp(d).conjugate() * rotation_exp<double>(d + e));
      const V behind = rotation_log<double>(rotation_exp(d).conjugate() * rotation_exp<double>(d - e));
      EXPECT_LT(((ahead - behind) / (2 * step) - jacobian.col(a)).norm(), 1e-9) << d.transpose();
    }
  }
}

TEST(Rotation, RightJacobianInverseInverts) {
  // Series of both end at a⁴ terms of a² < 1e-3: about 1e-9 is left of the product.
  for (const V& d : vectors(4.0))
    EXPECT_LT((right_jacobian_inverse(d) * right_jacobian(d) - Mat3<double>::Identity()).norm(), 1e-8)
        << d.transpose();
}

TEST(Rotation, JacobiansKeepFloatDigitsNearZero) {
  for (const V& d : vectors(3.1)) {
    const Vec3<float> f = d.cast<float>();
    // 1e-4: (a − sin a)/a³ loses four of seven digits where the closed form begins (a² = 1e-3) …
    EXPECT_LT((right_jacobian(f).cast<double>() - right_jacobian(d)).norm(), 1e-4) << d.transpose();
    EXPECT_LT((right_jacobian_inverse(f).cast<double>() - right_jacobian_inverse(d)).norm(), 1e-4)
        << d.transpose();
  }
}

TEST(Rotation, TwistIgnoresSwing) {
  const V axis = V(1, 2, -0.5).normalized();
  const V across = axis.unitOrthogonal();
  for (const double twist : {-3.1, -1.0, 0.0, 0.3, 2.0, 3.1})
    for (const double swing : {-2.0, 0.0, 1.2}) {
      const Quat<double> q = rotation_exp<double>(across * swing) * rotation_exp<double>(axis * twist);
      EXPECT_NEAR(twist_angle(q, axis), twist, 1e-12);
      const Quat<double> negated(-q.w(), -q.x(), -q.y(), -q.z());
      EXPECT_NEAR(twist_angle(negated, axis), twist, 1e-12);
    }
}

TEST(Rotation, BetweenTakesOneDirectionToTheOtherTheShorterWay) {
  for (const V& from : vectors(6.0))
    for (const V& to : vectors(6.0)) {
      if (from.norm() < 1e-6 || to.norm() < 1e-6) continue;  // their direction is lost in squares
      const Quat<double> q = rotation_between<double>(from, to);
      // Within a millionth of opposite any axis across serves, so the end is reached to the root of its
      // square.
      EXPECT_LT((q * from.normalized() - to.normalized()).norm(), 1e-5);
      EXPECT_NEAR(rotation_log(q).norm(),
                  std::acos(std::clamp(from.normalized().dot(to.normalized()), -1.0, 1.0)), 1e-5);
    }
}

TEST(Rotation, BetweenOppositesIsHalfATurn) {
  for (const V& from : {V(1, 0, 0), V(0, -2, 0), V(0, 0, 3), V(1, 2, 3)}) {
    const Quat<double> q = rotation_between<double>(from, V(-from));
    EXPECT_NEAR(q.norm(), 1, 1e-15);
    EXPECT_LT((q * from + from).norm(), 1e-14 * from.norm());
  }
}

TEST(PrincipalAxes, DiagonaliseASymmetricMatrix) {
  Mat3<double> m;
  m << 4, 1, -2, 1, 3, 0.5, -2, 0.5, 6;
  const auto [values, axes] = principal_axes(m);
  EXPECT_LE(values[0], values[1]);
  EXPECT_LE(values[1], values[2]);
  EXPECT_LT((axes * values.asDiagonal() * axes.transpose() - m).norm(), 1e-14);
  EXPECT_LT((axes.transpose() * axes - Mat3<double>::Identity()).norm(), 1e-14);
}

TEST(Transform, InverseUndoesAndProductsChain) {
  const Transform<double> a{rotation_exp<double>({0.3, -1, 2}), {1, 2, 3}};
  const Transform<double> b{rotation_exp<double>({-1.3, 0.2, 0.1}), {-4, 0, 1}};
  const V x(0.7, -0.2, 5);
  EXPECT_LT(((a * b) * x - a * (b * x)).norm(), 1e-13);
  EXPECT_LT((a.inverse() * (a * x) - x).norm(), 1e-13);
}

}  // namespace
}  // namespace sinew
