// What the ground can do for a root that has nothing else: forces within friction that balance what is asked.
#include "sinew/effects/ground_balance.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sinew {
namespace {

using V = Vec3<double>;
constexpr double kWeight = 736;  ///< N

/// Two feet of four points each, `apart` m from middle to middle.
template <class T>
std::vector<BearingPoint<T>> feet(double apart, double friction = 0.8) {
  std::vector<BearingPoint<T>> points;
  for (const double side : {0.5, -0.5})
    for (const double x : {-0.08, 0.16})
      for (const double y : {-0.03, 0.03})
        points.push_back(
            {Vec3<T>(T(x), T(side * apart + y), T(-0.95)), Vec3<T>::UnitZ(), T(1), T(friction), 0});
  return points;
}

/// The wrench that is left.
template <class T>
std::pair<V, V> left_of(const std::vector<BearingPoint<T>>& points, V force, V moment) {
  for (const BearingPoint<T>& p : points) {
    force -= p.force.template cast<double>();
    moment -= p.place.template cast<double>().cross(V(p.force.template cast<double>()));
  }
  return {force, moment};
}

template <class T>
void expect_within_friction(const std::vector<BearingPoint<T>>& points) {
  for (const BearingPoint<T>& p : points) {
    EXPECT_GE(double(p.force.z()), -1e-6 * kWeight);
    EXPECT_LE(double(p.force.template head<2>().norm()), double(p.friction * p.force.z()) + 1e-4 * kWeight);
  }
}

/// What weight at a place, pushed level, asks for.
V moment_of(const V& at, const V& force) {
  return at.cross(force);
}

template <class T>
class GroundBalance : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(GroundBalance, Scalars);

TYPED_TEST(GroundBalance, HoldsWhatIsWithinTheSolesAndFriction) {
  using T = TypeParam;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-0.07, 0.15), across(-0.12, 0.12), push(-0.4, 0.4);
  for (int n = 0; n < 300; ++n) {
    auto points = feet<T>(0.2);
    const V force(push(random) * kWeight, push(random) * kWeight, kWeight);
    // The line of action meets the ground within the soles.
    const V moment = moment_of({along(random), across(random), -0.95}, force);
    const int steps = balance_ground<T>(points, force.cast<T>(), moment.cast<T>(), T(kWeight), T(1));
    EXPECT_LT(steps, kBalanceSteps);
    const auto [f, m] = left_of<T>(points, force, moment);
    EXPECT_LT(f.norm(), 1) << n;  // N and N·m: a tenth of the help that a character has
    EXPECT_LT(m.norm(), 1) << n;
    expect_within_friction<T>(points);
  }
}

TYPED_TEST(GroundBalance, PressesAtTheEdgeWhereTheWeightIsBeyondIt) {
  using T = TypeParam;
  auto points = feet<T>(0.2);
  const V force(0, 0, kWeight), moment = moment_of({0.30, 0, 0}, force);
  balance_ground<T>(points, force.cast<T>(), moment.cast<T>(), T(kWeight), T(1));
  const auto [f, m] = left_of<T>(points, force, moment);
  expect_within_friction<T>(points);
  // The toes are at 0.16: 0.14 m of the weight's lever is nobody's. Weight is traded for tilt, so less.
  EXPECT_GT(m.norm() + 0.3 * f.norm(), 0.5 * 0.14 * kWeight);
  EXPECT_LT(m.norm(), 1.05 * 0.14 * kWeight);
}

TYPED_TEST(GroundBalance, IceHoldsNoPush) {
  using T = TypeParam;
  auto points = feet<T>(0.2, 0.05);
  const V force(0.3 * kWeight, 0, kWeight), moment = moment_of({0, 0, -0.95}, force);
  balance_ground<T>(points, force.cast<T>(), moment.cast<T>(), T(kWeight), T(1));
  expect_within_friction<T>(points);
  EXPECT_GT(left_of<T>(points, force, moment).first.norm(), 0.2 * kWeight);
}

/// Toes just before they leave the ground, of a runner whose motion asks more of them than they can give.
TYPED_TEST(GroundBalance, IsNoWorseThanNothingWhereLittleStands) {
  using T = TypeParam;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.01, 1), level(-0.15, 0.15), up(0, 0.3), tilt(-0.2, 0.2);
  for (int n = 0; n < 1000; ++n) {
    std::vector<BearingPoint<T>> points(2);
    points[0] = {Vec3<T>(T(-0.419), T(-0.069), T(-0.931)), Vec3<T>::UnitZ(), T(1), T(0.8), 0};
    points[1] = {Vec3<T>(T(-0.426), T(0.022), T(-0.921)), Vec3<T>::UnitZ(), T(share(random)), T(0.8), 0};
    const V force = kWeight * V(level(random), level(random), up(random));
    points[1].force = (0.9 * force).cast<T>();  // of which it gives what its friction lets it
    V middle = V::Zero();
    double total = 0;
    for (const auto& p : points) {
      middle += double(p.share) * p.place.template cast<double>();
      total += double(p.share);
    }
    middle /= total;
    const V about = kWeight * V(tilt(random), tilt(random), tilt(random)),
            moment = about + middle.cross(force);
    balance_ground<T>(points, force.cast<T>(), moment.cast<T>(), T(kWeight), T(1));
    const auto [f, m] = left_of<T>(points, force, moment);
    const double left = std::hypot(f.norm(), V(m - middle.cross(f)).norm()),
                 asked = std::hypot(force.norm(), about.norm());
    EXPECT_LT(left, 1.01 * asked + 1) << n;
    expect_within_friction<T>(points);
  }
}

TYPED_TEST(GroundBalance, NothingStandsNothingBears) {
  std::vector<BearingPoint<TypeParam>> none;
  EXPECT_EQ(balance_ground<TypeParam>(none, Vec3<TypeParam>(0, 0, 700), Vec3<TypeParam>::Zero(),
                                      TypeParam(kWeight), TypeParam(1)),
            0);
}

TEST(GroundBalance, LeavesAsLittleAsTheBestForcesDo) {
  // Against 20 000 projected gradient steps on the same problem, also where no forces balance.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.4, 0.4), push(-1, 1);
  for (int n = 0; n < 20; ++n) {
    auto points = feet<double>(0.2);
    const V force(push(random) * kWeight, push(random) * kWeight, kWeight);
    const V moment = moment_of({place(random), place(random), -0.95}, force);
    auto slow = points;
    V middle = V::Zero();
    for (const auto& p : points) middle += p.place / double(points.size());
    double bound = 0;
    for (const auto& p : points) bound += 1 + (p.place - middle).squaredNorm();
    const auto miss = [&](const std::vector<BearingPoint<double>>& of) {
      const auto [f, m] = left_of<double>(of, force, moment);
      return f.squaredNorm() + (m - middle.cross(f)).squaredNorm();
    };
    for (int k = 0; k < 20000; ++k) {
      const auto [f, m] = left_of<double>(slow, force, moment);
      const V about = m - middle.cross(f);
      for (auto& p : slow) {
        V x = p.force + (f + about.cross(V(p.place - middle))) / bound;
        const double s = x.head<2>().norm(), z = x.z(), mu = p.friction;
        if (s > mu * z) {
          const double keep = std::max((mu * s + z) / (mu * mu + 1), 0.0);
          x.head<2>() *= s > 0 ? mu * keep / s : 0;
          x.z() = keep;
        }
        p.force = x;
      }
    }
    balance_ground<double>(points, force, moment, kWeight, 1);
    EXPECT_LT(std::sqrt(miss(points)), std::sqrt(miss(slow)) * 1.02 + 1) << n;
  }
}

}  // namespace
}  // namespace sinew
