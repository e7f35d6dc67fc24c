// What a stage measures of a world whose answer is known. tests/study_audit has the books themselves.
#include <gtest/gtest.h>

#include "study/bodies.h"

namespace sinew::study {
namespace {

TEST(Stage, KineticAndPotentialEnergyOfAMovingBodyAreTheTextbooks) {
  const Skeleton body = free_body(2, {0.1, 0.2, 0.3});
  std::vector<JointJet<double>> jets = rest_jets<double>(body);
  jets[0].velocity = {3, 0, 0};
  jets[0].omega = {0, 0, 4};
  jets[0].translation = {0, 0, 5};
  const Energy e = energy_of(body, jets, {0, 0, -10});
  EXPECT_DOUBLE_EQ(e.kinetic, 0.5 * 2 * 9 + 0.5 * 0.3 * 16);
  EXPECT_DOUBLE_EQ(e.potential, 2 * 10 * 5);
}

TEST(Stage, AFreeFallNeitherGainsNorIsPushed) {
  WorldSettings settings;
  settings.ground = false;
  Stage<double> stage(settings);
  stage.add(free_body(2, {0.1, 0.1, 0.1}), passive());
  stage.run(1, 0.01);
  EXPECT_EQ(stage.measured().steps, 100);
  EXPECT_NEAR(stage.kinetic(), 0.5 * 2 * 9.81 * 9.81, 0.02 * 0.5 * 2 * 9.81 * 9.81);  // first steps: order h
  EXPECT_LE(stage.measured().energy_gain, 1e-9);
  EXPECT_EQ(stage.measured().work, 0);
}

TEST(Stage, WorkOfAPushIsTheKineticEnergyThatItLeaves) {
  Stage<double> stage(weightless());
  stage.add(free_body(2, {0.1, 0.1, 0.1}), passive());
  // A force over many steps: implicit Euler's first order error fades with their number.
  for (int n = 0; n < 1000; ++n) {
    stage.push(0, 0, stage.character(0).model()[0].translation, Vec3<double>(0.01, 0, 0));
    stage.step(0.001);
  }
  EXPECT_NEAR(stage.kinetic(), 0.5 * 2 * 25, 0.1);
  EXPECT_NEAR(stage.measured().work, 25, 0.1);
}

void add_swinging_chain(Stage<double>& stage, int links) {
  const Skeleton body = chain({links, JointType::kBall, JointType::kFree, 0.5});
  std::vector<JointJet<double>> jets = rest_jets<double>(body);
  randomise_speeds(body, jets, 2, 1);
  stage.add(body, passive(), jets);
}

TEST(Stage, AStrikeIsBookedWithTheEnergyThatItLeaves) {
  // On the end of a chain that swings; steps so short that they lose nothing of it.
  Stage<double> stage(weightless());
  add_swinging_chain(stage, 4);
  for (int n = 0; n < 10; ++n) stage.step(1e-4);
  const double before = stage.kinetic();
  stage.push(0, 3, stage.character(0).model()[3].translation, Vec3<double>(5, -2, 3));
  // A strike in the middle of a step: the next one shows what it left.
  stage.step(1e-4);
  // A strike in the middle of a step: the next one shows what it left.
  stage.step(1e-4);
  stage.step(1e-4);
  EXPECT_GT(stage.measured().work, 10);
  EXPECT_NEAR(stage.kinetic() - before, stage.measured().work, 0.01 * stage.measured().work);
}

TEST(Stage, JointGapSeesAnOpenJoint) {
  // A welded child whose rest place the world keeps: closed to rounding; the meter reads metres.
  Stage<double> stage(weightless());
  add_swinging_chain(stage, 3);
  stage.run(1, 0.01);
  EXPECT_LE(stage.measured().joint_gap, 1e-12);
  const auto model = stage.character(0).model();
  EXPECT_GT((model[2].translation - model[0].translation).norm(), 0.1);
}

TEST(Stage, PercentileOfPassesCountsSolvedSteps) {
  Measurement m;
  CharacterReport report;
  for (int n = 1; n <= 100; ++n) {
    report.outer_passes = n == 100 ? 60 : n > 50 ? 3 : 2;
    m.count(report);
  }
  EXPECT_EQ(m.passes_percentile(0.5), 2);
  EXPECT_EQ(m.passes_percentile(0.99), 3);
  EXPECT_EQ(m.most_passes, 60);
}

}  // namespace
}  // namespace sinew::study
