// Endurance. SINEW_SOAK_SECONDS sets the simulated time (the catalogue's is an hour, 3600).
#include "study/soak.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

/// Instrumented code is some ten times slower. The first who is pushed falls onto somebody in the third
/// second.
#ifdef __SANITIZE_ADDRESS__
constexpr double kUsualSeconds = 5;
#else
constexpr double kUsualSeconds = 10;
#endif

template <class T>
void expect_endurance() {
  const char* text = std::getenv("SINEW_SOAK_SECONDS");
  const SoakReport report = soak<T>(text ? std::atof(text) : kUsualSeconds, 1.0 / 60, 1);
  testing::Test::RecordProperty("frames", report.frames);
  testing::Test::RecordProperty("unconverged", report.measured.unconverged);
  EXPECT_EQ(report.not_finite, 0);
  EXPECT_EQ(report.heap_growth, 0) << "bytes";
  EXPECT_GT(report.measured.solved, report.frames / 10) << "nothing was disturbed";
  EXPECT_GT(report.touching, report.looked / 10) << "nobody touched anybody";
  // The catalogue's bound on steps that stop at their cap.
  const double share = report.measured.unconverged_share();
  const char* known = known_failure("soak_hour", text == nullptr);
  if (known && share > 1e-3) GTEST_SKIP() << "known failure: " << known << "; today " << share;
  EXPECT_LE(share, 1e-3) << report.measured.unconverged << " of " << report.measured.solved;
}

TEST(Soak, TwentyInACrowdStayFiniteAndTakeNoMemoryInFloat) {
  expect_endurance<float>();
}

TEST(Soak, TwentyInACrowdStayFiniteAndTakeNoMemoryInDouble) {
  expect_endurance<double>();
}

}  // namespace
}  // namespace sinew::study
