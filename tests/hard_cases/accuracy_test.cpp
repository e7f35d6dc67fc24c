// The accuracy study measures what it says, and our schemes have the order that theory gives them.
#include "study/accuracy.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "sinew/skeleton/rotation.h"
#include "study/accuracy_report.h"
#include "study/accuracy_store.h"
#include "study/bodies.h"

namespace sinew::study {
namespace {

AccuracyPoint point(double us, double error, const char* engine = "Sinew", double h = 1) {
  AccuracyPoint p;
  p.engine = engine;
  p.h = h, p.us = us, p.error = error;
  p.survived = true;
  return p;
}

TEST(AccuracyStudy, DisplacementIsTheRootMeanSquareOfAllMass) {
  const Skeleton box = box_body(3, {0.2, 0.4, 0.6});
  const std::vector<Transform<double>> here(1);
  std::vector<Transform<double>> there(1);
  there[0].translation = {0.3, 0, 0.4};
  EXPECT_NEAR(displacement(box, here, there), 0.5, 1e-12);
  // Turned by a half about z, a point at (x, y) moves by 2·√(x² + y²): its mean square is 4·Izz/m.
  there[0].translation.setZero();
  there[0].rotation = rotation_exp<double>({0, 0, 3.14159265358979});
  EXPECT_NEAR(displacement(box, here, there), 2 * std::sqrt((0.04 + 0.16) / 12), 1e-9);
}

TEST(AccuracyStudy, OrderIsTheSlopeOfAPowerLawAndSkipsWhatDidNotSurvive) {
  std::vector<AccuracyPoint> points;
  for (const double h : {0.1, 0.05, 0.025}) points.push_back(point(1, 3 * std::pow(h, 1.7), "", h));
  points.push_back(point(1, 100, "", 0.2));
  points.back().survived = false;
  EXPECT_NEAR(order_of(points), 1.7, 1e-9);
  EXPECT_EQ(order_of({}), 0);
}

TEST(AccuracyStudy, TheFrontHoldsWhatNothingBeats) {
  std::vector<AccuracyPoint> points{point(1, 1), point(2, 0.5), point(3, 0.7), point(4, 0.1), point(4, 0.2)};
  points.push_back(point(0.1, 0.01));
  points.back().survived = false;
  mark_pareto(points);
  std::vector<bool> front;
  for (const AccuracyPoint& p : points) front.push_back(p.pareto);
  EXPECT_EQ(front, (std::vector<bool>{true, true, false, true, false, false}));
}

TEST(AccuracyStudy, PriceIsTheCheapestWithinTheErrorPerEngine) {
  const std::vector<AccuracyPoint> points{point(9, 1e-4), point(5, 1e-3), point(7, 1e-3),
                                          point(1, 1e-5, "Peer")};
  EXPECT_EQ(cheapest(points, "Sinew", 2e-3), &points[1]);
  EXPECT_EQ(cheapest(points, "Sinew", 5e-4), &points[0]);
  EXPECT_EQ(cheapest(points, "Sinew", 1e-6), nullptr);
  EXPECT_EQ(cheapest(points, "Peer", 2e-3), &points[3]);
}

TEST(AccuracyStudy, WhatAGameCanHaveIsTheDefaultSchemeInStepsOfAFrameAndFiner) {
  std::vector<AccuracyPoint> points;
  for (const auto& [option, h] :
       {std::pair("bossak float", 1.0 / 30), std::pair("bossak float", 1.0 / 60),
        std::pair("bossak double", 1.0 / 120), std::pair("bdf1 float", 1.0 / 60),
        std::pair("momentum double", 1.0 / 60), std::pair("DASSL on residuals", 0.0)})
    points.push_back(point(1, 1, "Sinew", h)), points.back().option = option;
  points.push_back(point(1, 1, "Peer", 1.0 / 60));
  points.back().option = "bdf1 float";
  std::vector<std::string> left;
  for (const AccuracyPoint& p : at_60_hz(points)) left.push_back(p.label());
  EXPECT_EQ(left, (std::vector<std::string>{"Sinew bossak float", "Sinew bossak double",
                                            "Sinew DASSL on residuals", "Peer bdf1 float"}));
}

TEST(AccuracyStudy, TellsWhichPeersAreAheadOfOurs) {
  const auto point = [](const char* engine, const char* option, double us, double error) {
    AccuracyPoint p;
    p.engine = engine;
    p.option = option;
    p.varied = "step";
    p.h = 1.0 / 60;
    p.survived = true;
    p.us = us;
    p.error = error;
    return p;
  };
  EXPECT_TRUE(ahead_of_ours({point("Peer", "Euler", 1, 1)}).empty()) << "nothing to compare with";
  const auto found = ahead_of_ours({point("Peer", "Euler", 2, 1e-3), point("Sinew", "bossak float", 3, 1e-2),
                                    point("Peer", "RK4", 1, 5e-3), point("Dear", "Euler", 4, 1e-3),
                                    point("Far", "Euler", 1, 1)});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].engine, "Sinew");
  EXPECT_EQ(found[1].option, "RK4") << "the cheapest of the peer that is ahead";
}

TEST(AccuracyStudy, SchemesHaveTheirOrderAndOursIsExactForATumblingBody) {
  for (const char* scene : {"tumbling", "pendulum"}) {
    const std::vector<AccuracyResult> results = run_accuracy({true, scene}, {});
    ASSERT_EQ(results.size(), 1u);
    ASSERT_EQ(results[0].slopes.size(), 4u);
    for (const Slope& slope : results[0].slopes) {
      const bool second = slope.option.starts_with("bdf2") || slope.option.starts_with("bossak");
      const bool exact = slope.option.starts_with("bossak") && scene == std::string("tumbling");
      const double order = exact ? 0 : second ? 2 : 1;
      EXPECT_EQ(slope.expected, order) << scene << " " << slope.option;
      // The leading error term rules to a tenth or so from 1/240 s on.
      EXPECT_NEAR(slope.found, order, 0.2) << scene << " " << slope.option;
    }
  }
}

TEST(AccuracyStudy, GoesOnWhereItWasStoppedAndForgetsWhatAnotherBuildMade) {
  const std::string file = testing::TempDir() + "points_" + std::to_string(getpid()) + ".jsonl";
  std::filesystem::remove(file);
  AccuracyPoint made = point(3, 1e-3);
  made.option = "bdf2", made.varied = "step", made.degrees = 2;
  ResultStore(file, "one").keep("a", point_json(made));
  std::ofstream(file, std::ios::app)
      << "{\"build\": \"one\", \"key\": \"b\", \"res";  // stopped while writing
  const ResultStore again(file, "one");
  ASSERT_NE(again.find("a"), nullptr);
  EXPECT_EQ(point_json(point_from(*again.find("a"))), point_json(made));
  EXPECT_EQ(again.find("b"), nullptr);
  EXPECT_EQ(ResultStore(file, "two").find("a"), nullptr);
  std::filesystem::remove(file);
}

TEST(AccuracyStudy, CountedInstructionsRepeatToTheDigitAndGrowWithTheSteps) {
  if (!can_count_instructions())
    GTEST_SKIP() << "valgrind is not installed, or this program watches its own memory";
  const AccuracyScene tumbling = accuracy_scenes()[0];
  const EngineOption ours = sinew_options()[0];
  const double once = instructions_of(tumbling, ours, 1.0 / 30),
               again = instructions_of(tumbling, ours, 1.0 / 30);
  EXPECT_GT(once, 0);
  EXPECT_EQ(once, again);
  EXPECT_GT(instructions_of(tumbling, ours, 1.0 / 60), 1.5 * once);
  const std::vector<AccuracyScene> all = accuracy_scenes();
  const auto walk =
      std::find_if(all.begin(), all.end(), [](const AccuracyScene& s) { return s.name == "tracking"; });
  EXPECT_GT(instructions_of(*walk, ours, 1.0 / 30), once);  // a whole mannequin
}

TEST(AccuracyStudy, OnlyLevelsOfDetailThatSolveFeelThePush) {
  const std::vector<AccuracyResult> results = run_accuracy({true, "lod"}, {});
  ASSERT_EQ(results.size(), 1u);
  const auto error = [&](const std::string& option) {
    for (const AccuracyPoint& p : results[0].points)
      if (p.option == option) return p.survived ? p.error : -1;
    return -1.0;
  };
  // An arm and a back that give way move all mass by 15 mm (rms); who solves in time knows that to 2 mm.
  for (const char* blind : {"residual only", "playback only"}) EXPECT_GT(error(blind), 0.01) << blind;
  EXPECT_GE(error("every frame"), 0);
  EXPECT_LT(error("every frame"), 0.005);
  EXPECT_GE(error("every 2nd frame"), 0);
  EXPECT_LT(error("every 2nd frame"), 0.005);
  EXPECT_FALSE(draw_accuracy(results[0], testing::TempDir() + "lod.png"));
}

}  // namespace
}  // namespace sinew::study
