// The judge of falls: energies from nothing but poses, and means over seeds.
#include "study/ensembles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "study/bodies.h"

namespace sinew::study {
namespace {

/// A body that turns about its centre of mass, which moves in a straight line, at a moment.
std::vector<Transform<double>> flying(const Skeleton& body, const Vec3<double>& velocity,
                                      const Vec3<double>& spin, double t) {
  const Quat<double> turned = rotation_exp<double>(spin * t);
  return {{turned, velocity * t - turned * body.joints[0].center_of_mass}};
}

TEST(Ensembles, EnergyOfPosesIsTheTextbooks) {
  Skeleton body = free_body(2, {0.1, 0.2, 0.3});
  body.joints[0].center_of_mass = {0.3, -0.2, 0.1};
  const Vec3<double> velocity(3, 0, 1), spin(0, 4, 0);  // about a principal axis
  const double energy =
      kinetic_energy(body, flying(body, velocity, spin, 0.4), flying(body, velocity, spin, 0.6), 0.2);
  EXPECT_NEAR(energy, 0.5 * (2 * velocity.squaredNorm() + 0.2 * 16), 1e-12);
}

/// Sinew's own first option (its scheme in float).
EngineOption ours() {
  return sinew_options()[0];
}

Ensemble run(int scene, double hz, double finest, int seeds, double seconds) {
  const EnsembleScene& fall = ensemble_scenes()[scene];
  return run_ensemble(fall, ours(), hz, true_falls(fall, ours(), finest, seeds, seconds));
}

TEST(Ensembles, FinestStepsAreTheirOwnTruth) {
  const Ensemble e = run(0, 60, 60, 3, 0.5);
  ASSERT_EQ(e.seeds, 3);
  EXPECT_EQ(e.lost, 0);
  ASSERT_EQ(e.t.size(), 30u);
  EXPECT_NEAR(e.t.back(), 0.5, 1e-12);
  EXPECT_NEAR(e.share(0.25), 1, 0.01);  // in flight: what differs is the tolerance of the solves
}

TEST(Ensembles, FallingFiguresGainWhatGravityGives) {
  const Ensemble e = run(1, 60, 240, 4, 0.3);
  ASSERT_EQ(e.seeds, 4);
  // 75 kg, in the air for the first 0.2 s at least: the means before contact are those of the start and of a
  // free fall.
  const EngineScene start = ensemble_scenes()[1].start(1);
  const double fallen = 0.5 * start.figures[0].skeleton.total_mass() * std::pow(9.81 * 0.15, 2);
  const auto at = [&](double t) { return e.truth.mean[static_cast<std::size_t>(std::lround(60 * t)) - 1]; };
  EXPECT_NEAR(at(0.2) - at(0.05), fallen * (0.04 - 0.0025) / 0.0225, 0.06 * at(0.2));
}

TEST(Ensembles, MeansAreAsCertainAsTheirSpreadSays) {
  Ensemble e;
  e.hz = 60;
  e.seeds = 100;
  e.t = {1 / 60.0};
  e.energy = {{8}, {3}};
  e.truth = {{10}, {5}};
  EXPECT_DOUBLE_EQ(e.share(0), 0.8);
  EXPECT_NEAR(e.uncertainty(0), 0.8 * std::hypot(3 / 8.0, 5 / 10.0) / 10, 1e-12);
}

TEST(Ensembles, JsonHasACurveForEveryRun) {
  const Ensemble e = run(0, 30, 60, 2, 0.3);
  const nlohmann::json json = ensembles_json({e});
  const nlohmann::json& first = json.at("ensembles").at(0);
  EXPECT_EQ(first.at("engine"), "sinew");
  EXPECT_EQ(first.at("scheme"), "bossak");
  EXPECT_EQ(first.at("scalar"), "float");
  EXPECT_EQ(first.at("hz"), 30);
  EXPECT_EQ(first.at("seeds"), 2);
  for (const char* key : {"t", "energy", "energy_deviation", "truth", "truth_deviation"})
    EXPECT_EQ(first.at(key).size(), 9u) << key;
}

}  // namespace
}  // namespace sinew::study
