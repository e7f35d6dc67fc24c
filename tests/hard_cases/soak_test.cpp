// Endurance. SINEW_SOAK_SECONDS sets the simulated time (the catalogue's is an hour, 3600).
#include "study/soak.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace sinew::study {
namespace {

TEST(Soak, TwentyDisturbedCharactersStayFiniteAndTakeNoMemory) {
  const char* text = std::getenv("SINEW_SOAK_SECONDS");
  const SoakReport report = soak<float>(text ? std::atof(text) : 20, 1.0 / 60, 1);
  RecordProperty("frames", report.frames);
  RecordProperty("unconverged", report.measured.unconverged);
  EXPECT_EQ(report.not_finite, 0);
  EXPECT_EQ(report.heap_growth, 0) << "bytes";
  // The catalogue's bound on steps that stop at their cap.
  EXPECT_LE(report.measured.unconverged_share(), 1e-3)
      << report.measured.unconverged << " of " << report.measured.solved;
  EXPECT_GT(report.measured.solved, report.frames / 10) << "nothing was disturbed";
}

}  // namespace
}  // namespace sinew::study
