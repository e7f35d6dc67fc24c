#include "sinew/animation/blend_space.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

/// Nine clips, three of them on a line, as of a stick's directions with walk and run ahead.
constexpr double kPoints[] = {0, 0, 0, 1, 0, 2, 1, 0, -1, 0, 1, 1.2, -1, 1.2, 0, -1, 1, -1};
constexpr int kClips = 9;

BlendSpace directions() {
  BlendSpace space;
  const Status status = bake_blend_space(kPoints, 2, 33, space);
  EXPECT_TRUE(status.ok()) << status.reason;
  return space;
}
std::vector<TimeJet<double>> at(const BlendSpace& space, const TimeJet<double>& x, const TimeJet<double>& y) {
  std::vector<TimeJet<double>> weights(space.clips);
  const TimeJet<double> p[] = {x, y};
  blend_space_weights<double>(space, std::span(p).first(space.dimensions), weights);
  return weights;
}
double sum_of(const std::vector<TimeJet<double>>& weights) {
  double sum = 0;
  for (const auto& w : weights) sum += w.value;
  return sum;
}

TEST(BlendSpace, PlaysAClipAloneAtItsPoint) {
  const BlendSpace space = directions();
  for (int i = 0; i < kClips; ++i) {
    const auto weights = at(space, {kPoints[2 * i], 1, 0}, {kPoints[2 * i + 1], 1, 0});
    for (int k = 0; k < kClips; ++k) {
      EXPECT_NEAR(weights[k].value, k == i ? 1 : 0, 1e-6) << "clip " << k << " at point " << i;
      EXPECT_NEAR(weights[k].rate, 0, 1e-5);
    }
  }
}

TEST(BlendSpace, WeightsAddUpToOneAreNeverNegativeAndMoveSmoothlyRoundACircleThroughAll) {
  const BlendSpace space = directions();
  const auto on_circle = [&](double t) {  // one turn a second, partly outside all points
    const double a = 2 * 3.14159265358979323846, r = 1.3;
    return at(space, {r * std::cos(a * t), -a * r * std::sin(a * t), -a * a * r * std::cos(a * t)},
              {0.4 + r * std::sin(a * t), a * r * std::cos(a * t), -a * a * r * std::sin(a * t)});
  };
  constexpr double h = 1e-5;
  for (double t = 0; t < 1; t += 0.00173) {
    const auto now = on_circle(t), before = on_circle(t - h), after = on_circle(t + h);
    EXPECT_NEAR(sum_of(now), 1, 1e-6);  // node weights are floats
    for (int i = 0; i < kClips; ++i) {
      EXPECT_GE(now[i].value, -1e-15);
      EXPECT_NEAR((after[i].value - before[i].value) / (2 * h), now[i].rate, 1e-4) << i << " at " << t;
      // The third derivative of a cubic spline jumps: half of h times it. A jump of w'' would be tens.
      EXPECT_NEAR((after[i].rate - before[i].rate) / (2 * h), now[i].acceleration, 1) << i << " at " << t;
    }
  }
}

TEST(BlendSpace, BeyondItsPointsStaysAsAtTheEdge) {
  const BlendSpace space = directions();
  const auto edge = at(space, {0.2}, {2.6}), far = at(space, {0.2}, {1e9});
  for (int i = 0; i < kClips; ++i) EXPECT_NEAR(edge[i].value, far[i].value, 1e-6) << i;
}

TEST(BlendSpace, OneParameterBlendsNeighboursAlone) {
  constexpr double speeds[] = {0, 1.4, 3.5};
  BlendSpace space;
  ASSERT_TRUE(bake_blend_space(speeds, 1, 65, space).ok());
  for (double v = 0; v <= 3.5; v += 0.01) {
    const auto w = at(space, {v, 1, 0}, {0.0});
    EXPECT_NEAR(sum_of(w), 1, 1e-6);
    EXPECT_NEAR(w[v < 1.4 ? 2 : 0].value, 0, 1e-6) << v;
  }
  EXPECT_NEAR(at(space, {0.7}, {0.0})[0].value, 0.5, 0.02) << "half way between two points";
}

TEST(BlendSpace, RefusesWhatCannotBeMeant) {
  BlendSpace space;
  constexpr double near[] = {0, 1, 1.1}, odd[] = {0, 1, 2};
  EXPECT_EQ(bake_blend_space(near, 1, 33, space).index, 2);
  EXPECT_FALSE(bake_blend_space(odd, 2, 33, space).ok());
  EXPECT_FALSE(bake_blend_space(odd, 3, 33, space).ok());
  EXPECT_FALSE(bake_blend_space({}, 1, 33, space).ok());
  EXPECT_FALSE(bake_blend_space(odd, 1, 3, space).ok());
  constexpr double broken[] = {0, NAN};
  EXPECT_EQ(bake_blend_space(broken, 1, 33, space).code, Code::kNotFinite);
}

}  // namespace
}  // namespace sinew
