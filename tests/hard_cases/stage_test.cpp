// The meter itself: energy, work and joint gaps are what they should be where the answer is known.
#include <gtest/gtest.h>

#include "study/bodies.h"
#include "study/impulse_work.h"

namespace sinew::study {
namespace {

TEST(Books, KineticAndPotentialEnergyOfAMovingBodyAreTheTextbooks) {
  const Skeleton body = free_body(2, {0.1, 0.2, 0.3});
  std::vector<JointJet<double>> jets = rest_jets<double>(body);
  jets[0].velocity = {3, 0, 0};
  jets[0].omega = {0, 0, 4};
  jets[0].translation = {0, 0, 5};
  const Energy e = energy_of(body, jets, {0, 0, -10});
  EXPECT_DOUBLE_EQ(e.kinetic, 0.5 * 2 * 9 + 0.5 * 0.3 * 16);
  EXPECT_DOUBLE_EQ(e.potential, 2 * 10 * 5);
}

TEST(Books, AFreeFallNeitherGainsNorIsPushed) {
  WorldSettings settings;
  settings.ground = false;
  Stage<double> stage(settings);
  stage.add(free_body(2, {0.1, 0.1, 0.1}), limp());
  stage.run(1, 0.01);
  EXPECT_EQ(stage.measured().steps, 100);
  EXPECT_NEAR(stage.kinetic(), 0.5 * 2 * 9.81 * 9.81, 0.02 * 0.5 * 2 * 9.81 * 9.81);  // first steps: order h
  EXPECT_LE(stage.measured().energy_gain, 1e-9);
  EXPECT_EQ(stage.measured().work, 0);
}

TEST(Books, WorkOfAPushIsTheKineticEnergyThatItLeaves) {
  Stage<double> stage(weightless());
  stage.add(free_body(2, {0.1, 0.1, 0.1}), limp());
  // A force over many steps: implicit Euler's first order error fades with their number.
  for (int n = 0; n < 1000; ++n) {
    stage.push(0, 0, stage.character(0).model()[0].translation, Vec3<double>(0.01, 0, 0));
    stage.step(0.001);
  }
  EXPECT_NEAR(stage.kinetic(), 0.5 * 2 * 25, 0.1);
  EXPECT_NEAR(stage.measured().work, 25, 0.1);
}

TEST(Books, WorkOfAStrikeOnAFreeBodyIsTheTextbooks) {
  // Off its centre, while it moves: J·v + ½J²/m + ½(r × J)·I⁻¹(r × J).
  const Tree<double> tree(free_body(2, {0.1, 0.2, 0.3}));
  const std::vector<Transform<double>> local{{Quat<double>::Identity(), {1, 2, 3}}};
  const Vec3<double> arm(0.5, 0, 0), impulse(1, 3, 0), speed(4, 5, 6);
  const PointImpulse struck{0, local[0].translation + arm, impulse, speed};
  const double turned = arm.cross(impulse).z();
  const double expected = impulse.dot(speed) + impulse.squaredNorm() / (2 * 2) + turned * turned / (2 * 0.3);
  EXPECT_NEAR(work_of_impulses(tree, local, false, {&struck, 1}), expected, 1e-12);
  // Led, it does not move but as it does anyhow.
  EXPECT_NEAR(work_of_impulses(tree, local, true, {&struck, 1}), impulse.dot(speed), 1e-12);
}

TEST(Books, WorkOfAStrikeOnAHingedRodIsTheTextbooks) {
  // At a distance r from the hinge the rod has the mass I/r², I = ml²/3 about the hinge. A couple of two
  // impulses turns it by their sum.
  const Skeleton body = chain({2, JointType::kRevolute, JointType::kFree, 0.6});
  const Tree<double> tree(body);
  const std::vector<JointJet<double>> rest = rest_jets<double>(body);
  std::vector<Transform<double>> local;
  for (const JointJet<double>& jet : rest) local.push_back({jet.rotation, jet.translation});
  const Joint& rod = body.joints[1];
  const Vec3<double> axis = (local[0].rotation * local[1].rotation) * rod.axis;
  const Vec3<double> hinge = local[0] * local[1].translation;
  const Vec3<double> along = (local[0].rotation * local[1].rotation) * rod.center_of_mass.normalized();
  const Vec3<double> across = axis.cross(along).normalized();
  const double about = axis.dot(rod.inertia * axis) + rod.mass * rod.center_of_mass.squaredNorm();
  const auto at = [&](double r, double impulse) {
    return PointImpulse{1, hinge + r * along, impulse * across, 7 * r * across};
  };
  const PointImpulse one = at(0.5, 3);
  EXPECT_NEAR(work_of_impulses(tree, local, true, {&one, 1}), 3 * 7 * 0.5 + 1.5 * 1.5 / (2 * about), 1e-12);
  const PointImpulse two[] = {at(0.5, 3), at(0.2, -2)};
  const double torque = 0.5 * 3 - 0.2 * 2;
  EXPECT_NEAR(work_of_impulses(tree, local, true, two), 7 * torque + torque * torque / (2 * about), 1e-12);
}

void add_swinging_chain(Stage<double>& stage, int links) {
  const Skeleton body = chain({links, JointType::kBall, JointType::kFree, 0.5});
  std::vector<JointJet<double>> jets = rest_jets<double>(body);
  randomise_speeds(body, jets, 2, 1);
  stage.add(body, limp(), jets);
}

TEST(Books, AStrikeIsBookedWithTheEnergyThatItLeaves) {
  // On the end of a chain that swings; steps so short that they lose nothing of it.
  Stage<double> stage(weightless());
  add_swinging_chain(stage, 4);
  for (int n = 0; n < 10; ++n) stage.step(1e-4);
  const double before = stage.kinetic();
  stage.push(0, 3, stage.character(0).model()[3].translation, Vec3<double>(5, -2, 3));
  // A strike in the middle of a step: the next one shows what it left.
  stage.step(1e-4);
  stage.step(1e-4);
  EXPECT_GT(stage.measured().work, 10);
  EXPECT_NEAR(stage.kinetic() - before, stage.measured().work, 0.01 * stage.measured().work);
}

TEST(Books, JointGapSeesAnOpenJoint) {
  // A welded child whose rest place the world keeps: closed to rounding; the meter reads metres.
  Stage<double> stage(weightless());
  add_swinging_chain(stage, 3);
  stage.run(1, 0.01);
  EXPECT_LE(stage.measured().joint_gap, 1e-12);
  const auto model = stage.character(0).model();
  EXPECT_GT((model[2].translation - model[0].translation).norm(), 0.1);
}

TEST(Books, PercentileOfPassesCountsSolvedSteps) {
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
