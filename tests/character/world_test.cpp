// Convergence of limp falls, as the table in runtime/README.md; run `character_test` to print it.
#include <gtest/gtest.h>

#include <cstdio>

#include "character/scenes.h"

namespace sinew {
namespace {

using fixtures::Limp;

struct FallRow {
  double unconverged = 0;  ///< share of steps
  int above_start = 0;     ///< falls, of 40, whose energy ever passed that of their first step
};

template <class T>
FallRow fall(double h) {
  FallRow row;
  int bad = 0, steps = 0, passes = 0, factorisations = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    WorldSettings settings;
    Limp<T> limp(settings, 0.8, 3, seed);
    EXPECT_TRUE(limp.world.step(T(h)).ok());
    const double start = limp.energy();
    bool above = false;
    for (double t = 0; t < 3; t += h, ++steps) {
      EXPECT_TRUE(limp.world.step(T(h)).ok());
      const CharacterReport& report = limp.world.character(0).report();
      bad += !report.converged;
      passes += report.outer_passes;
      factorisations += report.factorisations;
      above = above || limp.energy() > start;
    }
    row.above_start += above;
  }
  row.unconverged = double(bad) / steps;
  std::printf(
      "h 1/%-3.0f %-6s  unconverged %.2f %%  above start %2d of 40  passes %.2f  factorisations %.2f\n",
      1 / h, sizeof(T) == 4 ? "float" : "double", 100 * row.unconverged, row.above_start,
      double(passes) / steps, double(factorisations) / steps);
  return row;
}

TEST(LimpFall, ConvergesAndGainsNoEnergyAtSixtyAndThirtyHertz) {
  // Unconverged, measured: none; the bounds leave room for other compilers' rounding.
  for (const double h : {1 / 60.0, 1 / 30.0}) {
    const double most = h < 0.02 ? 1e-4 : 1e-3;
    for (const FallRow& row : {fall<double>(h), fall<float>(h)}) {
      EXPECT_LE(row.unconverged, most);
      EXPECT_EQ(row.above_start, 0);
    }
  }
}

TEST(LimpFall, GainsNoEnergyAtFifteenHertz) {
  for (const FallRow& row : {fall<double>(1 / 15.0), fall<float>(1 / 15.0)}) EXPECT_EQ(row.above_start, 0);
}

}  // namespace
}  // namespace sinew
