// Bossak's scheme on one free body, and what it takes for smooth in time.
#include "sinew/optimizer/bossak.h"

#include <gtest/gtest.h>

#include "optimizer/free_body.h"
#include "sinew/optimizer/end_velocities.h"

namespace sinew {
namespace {

using fixtures::kPrincipal;
using fixtures::V;

/// Stepped as a world steps it, with the acceleration that gravity gives it from the start.
struct FreeBody : fixtures::FreeBody {
  EndVelocities<double> ends;

  FreeBody(const V& omega, const V& velocity, const V& gravity)
      : fixtures::FreeBody(omega, velocity, gravity) {
    ends.reserve(problem.capacity);
    history.acceleration[0] = gravity;
    history.torque[0].setZero();
  }
  void step(double h, double rho) {
    problem.start = problem.local;
    predict_bossak<double>(tree, history, {}, rho, h, V::Zero(), problem.prediction);
    minimise(h);
    advance_bossak<double>(tree, problem.kinematics, problem.prediction, problem.couple, {}, h, V::Zero(),
                           history);
  }
};

TEST(Bossak, FallsAlongTheParabolaWithUnequalStepsAndRadii) {
  const V gravity(0, 0, -9.81), velocity(3, 0, 2);
  FreeBody body(V::Zero(), velocity, gravity);
  const V start = body.history.center[0];
  double time = 0;
  for (const double h : {0.01, 0.02, 0.005, 1 / 60.0}) {
    body.step(h, h > 0.015 ? 0.8 : 0.3);
    time += h;
  }
  const V place = body.history.place + body.history.center[0];
  EXPECT_LT((place - (start + time * velocity + time * time / 2 * gravity)).norm(), 1e-9);
  EXPECT_LT((body.history.velocity[0] - (velocity + time * gravity)).norm(), 1e-7);
}

TEST(Bossak, KeepsTheMomentumAndTurnOfABodyThatTumbles) {
  const V spin(0.5, 9, 0.3);
  FreeBody body(spin, V::Zero(), V::Zero());
  const V before = body.history.momentum[0];
  for (int n = 0; n < 60; ++n) body.step(1 / 60.0, 0.8);
  EXPECT_LT((body.history.momentum[0] - before).norm(), 1e-6 * before.norm());
  const Mat3<double> exact =
      free_rotation<double>(kPrincipal.cwiseInverse().asDiagonal(), Mat3<double>::Identity(), before, 1.0);
  EXPECT_LT(Quat<double>(exact).angularDistance(Quat<double>(body.history.rotation[0])), 1e-4);
}

TEST(Bossak, SpectralRadiusFallsWithTheTurn) {
  for (const bool driven : {false, true}) {
    EXPECT_DOUBLE_EQ(spectral_radius(0.0, driven), spectral_radius(0.1, driven));
    EXPECT_LT(spectral_radius(0.5, driven), spectral_radius(0.2, driven));
    EXPECT_DOUBLE_EQ(spectral_radius(5.0, driven), spectral_radius(50.0, driven));
    EXPECT_GT(spectral_radius(50.0, driven), 0.0);
  }
  EXPECT_LT(spectral_radius(0.5, true), spectral_radius(0.5, false));
}

TEST(Bossak, ALimiterTakesAwayWhatHasJustComeOrTurned) {
  EXPECT_EQ(limited(5.0, 0.0, 0.0), 0);
  EXPECT_EQ(limited(5.0, 5.0, 0.0), 0);
  EXPECT_EQ(limited(5.0, 5.0, 5.0), 5);
  EXPECT_EQ(limited(5.0, 2.0, 3.0), 4);
  EXPECT_EQ(limited(5.0, -5.0, 5.0), 0);
  EXPECT_EQ(limited(-5.0, -2.0, -3.0), -4);
}

/// A contact that bears `force` (N) now.
Contact<double> bearing(double force, double last, double before, double smooth) {
  Contact<double> c;
  c.stiffness = 1e5;
  c.gap = -ContactLaw<double>::depth(c.stiffness, force, c.width());
  c.lagged_normal_force = c.lasting_last = last;
  c.lasting_before = before;
  c.smooth_before = smooth;
  return c;
}

TEST(Bossak, AContactThatHasJustClosedIsAnImpulse) {
  Contact<double> fresh = bearing(100, 0, 0, 0);
  split<double>(false, 0.6, fresh);
  EXPECT_EQ(fresh.smooth_force, 0);
  Contact<double> old = bearing(100, 100, 100, 100);
  split<double>(false, 0.6, old);
  EXPECT_NEAR(old.smooth_force, 100, 1e-9);
  Contact<double> lasts = bearing(100, 20, 55, 40);
  split<double>(true, 0.6, lasts);
  EXPECT_NEAR(lasts.smooth_force, 100, 1e-9);
  Contact<double> leaps = bearing(100, 20, 20, 15);
  split<double>(true, 0.6, leaps);
  EXPECT_NEAR(leaps.smooth_force, 40, 1e-9) << "twice what it was";
  EXPECT_NEAR(leaps.lasting_force, 40, 1e-9) << "a leap is not what lasts";
}

TEST(EndVelocities, AreWhatTheyWereWhereJointsAllowThem) {
  FreeBody body(V(1, 2, 3), V(3, -1, 2), V::Zero());
  TreeProblem<double>* const trees[] = {&body.problem};
  const std::vector<std::uint8_t> loose(6, 1);
  const std::vector<Twist<double>> driven(1);
  std::vector<std::array<double, 6>> rate(1);
  body.ends.begin(trees, loose);
  const V velocity = body.history.velocity[0], momentum = body.history.momentum[0];
  body.ends.project(0, driven, rate, {}, body.history);
  body.ends.write(0, body.history, rate);
  // The matrix' floor takes some 1e-6 of what is not in `rate` yet.
  EXPECT_LT((body.history.velocity[0] - velocity).norm(), 1e-4 * velocity.norm());
  EXPECT_LT((body.history.momentum[0] - momentum).norm(), 1e-4 * momentum.norm());
  const V once = body.history.velocity[0];
  body.ends.project(0, driven, rate, {}, body.history);
  body.ends.write(0, body.history, rate);
  EXPECT_LT((body.history.velocity[0] - once).norm(), 1e-9 * velocity.norm());
}

/// Speed along the normal (m/s) of a body's contact point after it was pressed, that came with `speed`.
double pressed(double speed, double force, double h) {
  FreeBody body(V::Zero(), V(0, 0, speed), V::Zero());
  TreeProblem<double>* const trees[] = {&body.problem};
  const std::vector<std::uint8_t> loose(6, 1);
  const std::vector<Twist<double>> driven(1);
  std::vector<std::array<double, 6>> rate(1);
  rate[0][2] = speed;
  body.ends.begin(trees, loose);
  body.ends.project(0, driven, rate, {}, body.history);
  Contact<double> c = bearing(force, 0, 0, 0);
  c.point = body.history.center[0];
  body.ends.add(c, 2 * h * force, 0, V::Zero());
  body.ends.press();
  body.ends.write(0, body.history, rate);
  return body.history.velocity[0].z();
}

/// Speed (m/s) along x that friction leaves of 1 m/s, where it may do `cone` (N·s) and `rubbed` of it was
/// done to a body of 2 kg whose contact is at its centre.
double rubbed(double cone, double rubbed) {
  FreeBody body(V::Zero(), V(1, 0, 0), V::Zero());
  TreeProblem<double>* const trees[] = {&body.problem};
  const std::vector<std::uint8_t> loose(6, 1);
  const std::vector<Twist<double>> driven(1);
  std::vector<std::array<double, 6>> rate(1);
  rate[0][0] = 1;
  body.ends.begin(trees, loose);
  body.ends.project(0, driven, rate, {}, body.history);
  Contact<double> c = bearing(100, 0, 0, 0);
  c.point = body.history.center[0];
  body.ends.add(c, 0, cone, V(-rubbed, 0, 0));
  body.ends.press();
  body.ends.write(0, body.history, rate);
  return body.history.velocity[0].x();
}

TEST(EndVelocities, FrictionStopsWhatSlidesAsFarAsItsConeAllows) {
  EXPECT_NEAR(rubbed(10, 0), 0, 1e-4);
  EXPECT_NEAR(rubbed(1, 0), 0.5, 1e-4);
  EXPECT_NEAR(rubbed(1, 1), 1, 1e-9);  // all was done
  EXPECT_NEAR(rubbed(0, 0), 1, 1e-9);
  EXPECT_NEAR(rubbed(3, 0.5), 0, 1e-4);
}

TEST(EndVelocities, AContactTakesOutWhatClosesAndNothingElse) {
  EXPECT_NEAR(pressed(-1, 1e6, 0.01), 0, 1e-4);
  EXPECT_NEAR(pressed(1, 1e6, 0.01), 1, 1e-9);
  const double hardly = pressed(-1, 10, 0.01);  // two steps of 10 N on 2 kg
  EXPECT_NEAR(hardly, -1 + 2 * 10 * 0.01 / 2, 1e-4);
}

}  // namespace
}  // namespace sinew
