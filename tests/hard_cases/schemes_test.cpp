// Schemes on one free body, against Euler's equations integrated finely by Runge–Kutta.
#include "study/schemes/schemes.h"

#include <gtest/gtest.h>

#include "optimizer/free_body.h"

namespace sinew::study {
namespace {

using fixtures::kPrincipal;
using fixtures::V;

const Bdf1<double> kBdf1;
const Bdf2<double> kBdf2;

/// Stepped as a world steps it: predict, minimise, advance.
struct FreeBody : fixtures::FreeBody {
  using fixtures::FreeBody::FreeBody;
  void step(double h, const TimeScheme<double>& scheme = kBdf2) {
    problem.start = problem.local;
    scheme.predict(tree, history, h, V::Zero(), problem.prediction);
    minimise(h);
    scheme.advance(tree, problem.kinematics, problem.prediction, problem.couple, h, V::Zero(), history);
  }
};

/// Rotation and world angular momentum of the torque-free body by Runge–Kutta 4.
struct Reference {
  Quat<double> rotation = Quat<double>::Identity();
  V omega;  // body axes
  explicit Reference(const V& w) : omega(w) {}
  static V rate(const V& w) { return -w.cross(kPrincipal.cwiseProduct(w)).cwiseQuotient(kPrincipal); }
  void run(double time) {
    constexpr double h = 1e-4;  // error of order h⁴: below 1e-11 here
    const int steps = static_cast<int>(std::lround(time / h));
    for (int n = 0; n < steps; ++n) {
      const auto turn = [](const Quat<double>& q, const V& w) {
        return Eigen::Vector4d((q * Quat<double>(0, w.x(), w.y(), w.z())).coeffs() * 0.5);
      };
      const auto moved = [&](const Eigen::Vector4d& dq, double s) {
        return Quat<double>(Eigen::Vector4d(rotation.coeffs() + s * dq));
      };
      const V k1 = rate(omega), w2 = omega + h / 2 * k1, k2 = rate(w2), w3 = omega + h / 2 * k2,
              k3 = rate(w3), w4 = omega + h * k3, k4 = rate(w4);
      const auto q1 = turn(rotation, omega), q2 = turn(moved(q1, h / 2), w2), q3 = turn(moved(q2, h / 2), w3),
                 q4 = turn(moved(q3, h), w4);
      rotation = moved(q1 + 2 * q2 + 2 * q3 + q4, h / 6).normalized();
      omega += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
  }
};

TEST(Bdf2, TumblingBodyKeepsItsAngularMomentum) {
  // 30 rad/s at 60 Hz: half a radian per step, mostly about the unstable axis.
  const V omega(3, 29.5, 4.5);
  FreeBody body(omega, V::Zero(), V::Zero());
  const V momentum = kPrincipal.cwiseProduct(omega);
  constexpr double h = 1 / 60.0;
  V turn_before = V::Zero();
  for (int n = 0; n < 600; ++n) {
    const Mat3<double> before = body.history.rotation[0];
    body.step(h);
    const Mat3<double>& now = body.history.rotation[0];
    const V turn = rotation_log<double>(Quat<double>(Mat3<double>(before.transpose() * now)));
    // What the poses themselves show, by the second-order backward difference; the first step is bdf1.
    const V shown = now * kPrincipal.cwiseProduct((3 * turn - turn_before) / (2 * h));
    if (n > 0) {
      ASSERT_LT((shown - momentum).norm(), 1e-3 * momentum.norm()) << "step " << n;
    }
    ASSERT_LT((body.history.momentum[0] - momentum).norm(), 1e-3 * momentum.norm()) << "step " << n;
    turn_before = turn;
  }
}

TEST(Bdf1, FreeSpinDecays) {
  // 0.12 of the spin is left after 2 s (prototype). If this fails the documents are out of date.
  FreeBody body(V(0, 0, 30), V::Zero(), V::Zero());
  V turn = V::Zero();
  for (int n = 0; n < 120; ++n) {
    const Mat3<double> before = body.history.rotation[0];
    body.step(1 / 60.0, kBdf1);
    turn = rotation_log<double>(Quat<double>(Mat3<double>(before.transpose() * body.history.rotation[0])));
  }
  EXPECT_LT(turn.norm() * 60, 15);
}

/// Rotation error (rad) after one second with steps of h, alternately longer and shorter by `uneven`.
double rotation_error(double h, double uneven, const TimeScheme<double>& scheme) {
  const V omega(1, 4, 2);
  Reference exact(omega);
  exact.run(1);
  FreeBody body(omega, V::Zero(), V::Zero());
  const int steps = static_cast<int>(std::lround(1 / h));
  for (int n = 0; n < steps; ++n) body.step(h * (n % 2 == 0 ? 1 + uneven : 1 - uneven), scheme);
  return exact.rotation.angularDistance(Quat<double>(body.history.rotation[0]));
}

TEST(Bdf2, TumblingConvergesWithSecondOrder) {
  const double coarse = rotation_error(1 / 60.0, 0, kBdf2), middle = rotation_error(1 / 120.0, 0, kBdf2),
               fine = rotation_error(1 / 240.0, 0, kBdf2);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.2);  // still nearing its limit
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.3);
  EXPECT_LT(fine, 0.01);
}

TEST(Bdf2, KeepsSecondOrderWithUnequalSteps) {
  const double coarse = rotation_error(1 / 120.0, 0.4, kBdf2), fine = rotation_error(1 / 240.0, 0.4, kBdf2);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

TEST(Bdf1, TumblingConvergesWithFirstOrder) {
  const double coarse = rotation_error(1 / 240.0, 0, kBdf1), fine = rotation_error(1 / 480.0, 0, kBdf1);
  EXPECT_NEAR(std::log2(coarse / fine), 1, 0.3);
}

TEST(Bdf2, ParabolaIsExactAlsoWithUnequalSteps) {
  // A second-order method integrates a constant acceleration exactly once it is under way; the first step is
  // bdf1, so start from two exact states.
  const V gravity(0.5, 0, -9.81), velocity(3, 1, 2);
  FreeBody body(V::Zero(), velocity, gravity);
  body.accuracy.tolerance = 1e-12;  // what a solve leaves adds up over the steps
  const auto center = [&] { return V(body.history.place + body.history.center[0]); };
  const V c0 = center();
  const auto exact = [&](double t) { return V(c0 + velocity * t + 0.5 * gravity * t * t); };
  double t = 0.02;
  const History<double> before = body.history;
  body.history.center[0] += exact(t) - c0;
  body.history.velocity[0] = velocity + gravity * t;
  Bdf2<double>::keep(before, t, body.history);
  for (const double h : {0.02, 0.013, 0.03, 0.007, 0.05, 0.02}) {
    body.step(h);
    t += h;
    EXPECT_LT((center() - exact(t)).norm(), 1e-9) << "after a step of " << h;
    EXPECT_LT((body.history.velocity[0] - (velocity + gravity * t)).norm(), 1e-7) << "after a step of " << h;
  }
}

TEST(Bdf2, BeginsWithBdf1) {
  FreeBody body(V(1, 2, 3), V::Zero(), V::Zero());
  kBdf2.predict(body.tree, body.history, 0.01, V::Zero(), body.problem.prediction);
  EXPECT_DOUBLE_EQ(body.problem.prediction.weight, 1 / 1e-4);
  body.step(0.01);
  kBdf2.predict(body.tree, body.history, 0.01, V::Zero(), body.problem.prediction);
  EXPECT_DOUBLE_EQ(body.problem.prediction.weight, 2.25 / 1e-4);
}

TEST(Bdf2, AbsurdSpinFallsBackToTheAffineTarget) {
  FreeBody body(V(10, 200, 30), V::Zero(), V::Zero());  // over 3 rad per step
  for (int n = 0; n < 60; ++n) {
    kBdf2.predict(body.tree, body.history, 1 / 60.0, V::Zero(), body.problem.prediction);
    ASSERT_TRUE(body.problem.prediction.rotation[0].allFinite());
    body.step(1 / 60.0);
    ASSERT_TRUE(body.history.momentum[0].allFinite());
  }
}

}  // namespace
}  // namespace sinew::study
