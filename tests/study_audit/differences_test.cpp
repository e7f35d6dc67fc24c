// Velocities from poses alone: their order, and whether they are as good as they say.
#include "study/audit/differences.h"

#include <gtest/gtest.h>

#include "study_audit/motions.h"

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

TEST(Differences, WeightsAreExactOnPolynomialsAtUnevenTimes) {
  const std::vector<double> times{-0.3, -0.1, 0, 0.04, 0.2, 0.5};
  const Weights weights(times, 0.04);
  for (int power = 0; power < 6; ++power) {
    double slope = 0, bend = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      slope += weights.first[i] * std::pow(times[i], power);
      bend += weights.second[i] * std::pow(times[i], power);
    }
    EXPECT_NEAR(slope, power ? power * std::pow(0.04, power - 1) : 0, 1e-11) << "power " << power;
    EXPECT_NEAR(bend, power > 1 ? power * (power - 1) * std::pow(0.04, power - 2) : 0, 1e-9)
        << "power " << power;
  }
}

/// At 0.3 s, from so many poses.
Velocity middle_velocity(const Path& path, double h, int points = 9) {
  std::vector<Transform<double>> poses;
  std::vector<double> times;
  for (int n = 0; n < points; ++n) {
    const int from_middle = n - points / 2;
    times.push_back(from_middle * h);
    poses.push_back(path(0.3 + times.back()));
  }
  return velocity_at(one_body(1, Vector3d::Ones()).bodies[0], poses, Stencils(times, points / 2), 1e-16);
}

Path swinging(double rate) {
  return [=](double t) {
    return Transform<double>{turn(Vector3d(0, std::sin(rate * t), 0)),
                             {std::sin(rate * t), std::cos(rate * t), 0}};
  };
}

TEST(Differences, AreOfSixthAndEighthOrder) {
  for (const int points : {7, 9}) {
    double before = 0;
    for (const double h : {0.16, 0.08, 0.04}) {
      const double off = (middle_velocity(swinging(3), h, points).linear.value -
                          3 * Vector3d(std::cos(0.9), -std::sin(0.9), 0))
                             .norm();
      if (before > 0) {
        EXPECT_NEAR(std::log2(before / off), points - 1, 0.2) << "h = " << h;
      }
      before = off;
    }
  }
}

TEST(Differences, AreWithinTheErrorThatTheySayAndSayLittleWhereMotionIsSmooth) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240})
    for (const double rate : {1.0, 3.0, 10.0}) {
      const Velocity v = middle_velocity(swinging(rate), h);
      const double s = std::sin(0.3 * rate), c = std::cos(0.3 * rate);
      EXPECT_LE((v.linear.value - rate * Vector3d(c, -s, 0)).norm(), v.linear.error);
      EXPECT_LE((v.angular.value - Vector3d(0, rate * c, 0)).norm(), v.angular.error);
      // Four times the sixth order's correction, (hω)⁴/30 of the fourth's error; (hω)⁵/90 by the second
      // derivative.
      EXPECT_LE(v.linear.error, 5 * rate * std::pow(h * rate, 4) / 30 + 1e-10) << "h = " << h << ", " << rate;
    }
}

TEST(Differences, OfATurnThatCannotBeFollowedKnowNothing) {
  const Path spinning = [](double t) {
    return Transform<double>{turn(Vector3d(0, 0, 60 * t)), Vector3d::Zero()};
  };
  EXPECT_NEAR(middle_velocity(spinning, 1.0 / 60).angular.value.z(), 60, 1e-9);
  EXPECT_TRUE(std::isinf(middle_velocity(spinning, 1.0 / 22).angular.error)) << "2.7 rad a step";
}

TEST(Differences, AcrossAnImpactAreWithinTheErrorThatTheySayWhereverItLies) {
  // A speed that swings and at some instant within reach of the node or beyond it leaps by 3 m/s.
  const double h = 1.0 / 60, rate = 5;
  int believed = 0;
  for (double at = -5.5; at < 5.5; at += 0.0117) {
    const double leap = 0.3 + at * h;
    const Path struck = [=](double t) {
      const double way = std::sin(rate * t) / rate + 3 * std::max(0.0, t - leap);
      return Transform<double>{Eigen::Quaterniond::Identity(), {way, 0, 0}};
    };
    const Velocity v = middle_velocity(struck, h);
    const double exact = std::cos(rate * 0.3) + (at < 0 ? 3 : 0);
    EXPECT_LE(std::abs(v.linear.value.x() - exact), v.linear.error + 1e-12) << at << " steps from the node";
    believed += v.linear.error < 1e-3;
    if (std::abs(at) < 1) {
      EXPECT_GE(v.linear.error, 0.5 * 3 * (1 - std::abs(at)) - 0.2);
    }
  }
  EXPECT_GT(believed, 100) << "beyond reach";
}

TEST(Differences, VelocityOnArrivalIsWithinItsError) {
  std::vector<Transform<double>> poses;
  std::vector<double> times;
  for (int n = 0; n < 9; ++n) {
    times.push_back(n / 60.0);
    poses.push_back(swinging(4)(times.back()));
  }
  const double t = times.back(), a = std::sin(4 * t), rate = 4 * std::cos(4 * t);
  const Vector3d arm(0, 0, 0.5);
  // Of the centre, and of the arm that turns about y by a.
  const Vector3d exact =
      Vector3d(rate, -4 * std::sin(4 * t), 0) + 0.5 * rate * Vector3d(std::cos(a), 0, -std::sin(a));
  const Estimate found = arriving_velocity(arm, poses, times);
  EXPECT_LE((found.value - exact).norm(), found.error);
  EXPECT_LE(found.error, 1e-2);
}

}  // namespace
}  // namespace sinew::audit
