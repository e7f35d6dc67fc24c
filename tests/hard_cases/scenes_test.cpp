// Ordinary situations, as `sinew study scenes --quick` judges them. What is known to fail must: whoever mends
// one takes it off the list.
#include <gtest/gtest.h>

#include <ostream>

#include "fixtures/known_failure.h"
#include "study/scenes/situation.h"

namespace sinew::study {

void PrintTo(const Situation& situation, std::ostream* out) {
  *out << situation.name << ": " << situation.about;
}

namespace {

class Situations : public testing::TestWithParam<Situation> {};

TEST_P(Situations, PassOrAreKnownToFail) {
  const Situation& situation = GetParam();
  const SituationResult result = run_situation(situation, true);
  ASSERT_EQ(result.findings.refused(), "");
  if (const char* why = known_to_fail(situation.name)) {
    EXPECT_FALSE(result.findings.passed()) << "passes: take it off the list";
    if (!HasFailure()) GTEST_SKIP() << "known to fail: " << why;
    return;
  }
  EXPECT_TRUE(result.findings.passed()) << situation_table(result);
}

INSTANTIATE_TEST_SUITE_P(All, Situations, testing::ValuesIn(situations()),
                         [](const auto& of) { return std::string(of.param.name); });

Solid box(const Eigen::Vector3d& half, const Eigen::Vector3d& at) {
  Solid s;
  s.shape = Shape::kBox;
  s.half = half;
  s.pose.translation() = at;
  return s;
}
Solid capsule(double radius, double half, const Eigen::Vector3d& at, const Eigen::Vector3d& axis) {
  Solid s;
  s.shape = Shape::kCapsule;
  s.radius = radius;
  s.half.z() = half;
  s.pose.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
  s.pose.translation() = at;
  return s;
}

TEST(Judge, OverlapsAreExact) {
  const Solid table = box({1, 1, 0.1}, {0, 0, 0});
  EXPECT_NEAR(overlap(box({0.1, 0.1, 0.1}, {0, 0, 0.195}), table), 5e-3, 1e-12);
  EXPECT_NEAR(overlap(capsule(0.1, 5, {0, 0, 0.19}, {1, 0, 0}), table), 0.01, 1e-6) << "beyond both edges";
  const double corner = std::sqrt(0.5) * 0.5;  // of a box that stands on its edge
  Solid tilted = box({0.25, 0.25, 0.25}, {0, 0, 0.1 + corner - 2e-3});
  tilted.pose.linear() = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(overlap(tilted, table), 2e-3, 1e-9);
  EXPECT_NEAR(overlap(capsule(0.1, 1, {0, 0, 0.15}, {1, 0, 0}), capsule(0.1, 1, {0, 0, 0}, {0, 1, 0})), 0.05,
              1e-12)
      << "crossed";
  EXPECT_NEAR(below(box({0.1, 0.2, 0.3}, {0, 0, 0.29}), 0), 0.01, 1e-12);
}

}  // namespace
}  // namespace sinew::study
