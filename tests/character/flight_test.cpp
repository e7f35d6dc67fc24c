// What a limp figure keeps in flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "character/scenes.h"

namespace sinew {
namespace {

struct Kept {
  double kinetic = 0;  ///< share of the kinetic energy after the first step
  double turning = 0;  ///< change of the angular momentum, share of it
  double sliding = 0;  ///< kg·m/s, change of the momentum
};

/// Two seconds without gravity at 60 Hz, joint speeds of `speed` rad/s rms at the start; mean of ten.
template <class T>
Kept fly(double speed) {
  Kept mean;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    WorldSettings settings;
    settings.ground = false;
    settings.gravity.setZero();
    fixtures::Limp<T> limp(settings, 5, speed, seed);
    EXPECT_TRUE(limp.world.step(T(1 / 60.0)).ok());
    const CharacterReport start = limp.world.character(0).report();
    for (int n = 1; n < 120; ++n) EXPECT_TRUE(limp.world.step(T(1 / 60.0)).ok());
    const CharacterReport& end = limp.world.character(0).report();
    mean.kinetic += end.kinetic_energy / start.kinetic_energy / 10;
    mean.turning +=
        (end.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm() / 10;
    mean.sliding += (end.momentum - start.momentum).norm() / 10;
  }
  std::printf("%-6s %2.0f rad/s: kinetic energy kept %.4f, angular momentum off %.1e, momentum %.1e kg m/s\n",
              sizeof(T) == 4 ? "float" : "double", speed, mean.kinetic, mean.turning, mean.sliding);
  return mean;
}

TEST(Flight, KeepsBothMomentaToRounding) {
  for (const double speed : {1.0, 3.0, 10.0}) {
    const Kept exact = fly<double>(speed), rounded = fly<float>(speed);
    EXPECT_LT(exact.turning, 1e-6) << speed;  // the common turn is found for one inertia, and made for all
    EXPECT_LT(exact.sliding, 1e-12 * 75 * speed) << speed;
    // Roundings of 120 steps, of limbs that carry more than the whole.
    EXPECT_LT(rounded.turning, 1e-4) << speed;
    EXPECT_LT(rounded.sliding, 1e-5 * 75 * speed) << speed;
    EXPECT_LE(exact.kinetic, 1) << speed;
    EXPECT_LE(rounded.kinetic, 1) << speed;
  }
}

/// Joints' places (m) of a limp figure at 3 rad/s rms, `seconds` after its reset, in `steps`.
std::vector<Vec3<double>> flown(unsigned seed, double seconds, int steps) {
  WorldSettings settings;
  settings.ground = false;
  settings.accuracy.tolerance = 1e-9;
  fixtures::Limp<double> limp(settings, 5, 3, seed);
  for (int n = 0; n < steps; ++n) EXPECT_TRUE(limp.world.step(seconds / steps).ok());
  EXPECT_EQ(limp.world.character(0).report().substeps, 1);
  std::vector<Vec3<double>> places;
  for (const Transform<double>& joint : limp.world.character(0).model()) places.push_back(joint.translation);
  return places;
}

double largest_distance(const std::vector<Vec3<double>>& a, const std::vector<Vec3<double>>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(Flight, BeginsWithAWholeStepOfSecondOrder) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto error = [&](double h) { return largest_distance(flown(seed, h, 1), flown(seed, h, 64)); };
    const double coarse = error(1 / 120.0), fine = error(1 / 240.0);
    std::printf("seed %u: first step off by %.2e m at 1/120 s, %.2e m at 1/240 s\n", seed, coarse, fine);
    // The error of one step falls with h³; of implicit Euler's with h², by a factor of four.
    EXPECT_GT(coarse / fine, 6) << seed;
  }
}

/// Momentum (kg·m/s) of a ball of 1 kg after two steps without gravity.
double thrown(double speed) {
  WorldSettings settings;
  settings.ground = false;
  settings.gravity.setZero();
  settings.detail.sleep_after = 0;
  World<float> world(settings);
  PropSettings ball;
  ball.mass = 1;
  ball.velocity = {speed, 0, 0};
  Status status;
  (void)world.add_prop(ball, status);
  EXPECT_TRUE(status.ok()) << status.reason;
  for (int n = 0; n < 2; ++n) EXPECT_TRUE(world.step(1 / 60.0f).ok());
  return world.prop_report(0).momentum.x();
}

TEST(Flight, KeepsSmallSpeedsButNoneThatAProcessorIsSlowWith) {
  EXPECT_NEAR(thrown(1e-20), 1e-20, 1e-26);
  EXPECT_EQ(thrown(1e-35), 0);  // its square, and what it moves in a step, are denormal
  EXPECT_EQ(thrown(1e-41), 0);
}

}  // namespace
}  // namespace sinew
