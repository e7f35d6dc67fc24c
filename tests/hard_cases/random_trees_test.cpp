// Trees nobody would build: half of them in float, half in double. SINEW_RANDOM_TREES sets their number (the
// catalogue's is 100000), SINEW_SEED runs one in both.
#include "study/random_trees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

int number(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

/// Instrumented code is some ten times slower.
#ifdef __SANITIZE_ADDRESS__
constexpr int kUsualCount = 40;
#else
constexpr int kUsualCount = 1000;
#endif

constexpr int kEnough = 400;  ///< trees for the rarest of what is expected: one in 50 restarts

std::string first_of(const std::vector<std::string>& faults) {
  std::string first;
  for (std::size_t i = 0; i < std::min<std::size_t>(faults.size(), 10); ++i) first += "\n" + faults[i];
  return first;
}

template <class T>
void expect_no_fault(std::uint64_t seed) {
  Measurement measured;
  const TreeFaults faults = faults_of_tree<T>(seed, measured);
  EXPECT_EQ(faults.fault, "") << "seed " << seed;
  if (!faults.leap.empty()) std::printf("known failure: seed %d %s\n", int(seed), faults.leap.c_str());
}

/// Half `half` (0 or 1) of the seeds.
template <class T>
void expect_no_faults(int half) {
  if (const int seed = number("SINEW_SEED", 0)) {
    expect_no_fault<T>(static_cast<std::uint64_t>(seed));
    return;
  }
  const int count = std::max(1, number("SINEW_RANDOM_TREES", kUsualCount) / 2);
  const RandomTreesReport report =
      run_random_trees<T>(1 + std::uint64_t(half) * std::uint64_t(count), count,
                          std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  EXPECT_TRUE(report.faults.empty()) << report.faults.size() << " of " << count
                                     << " trees; SINEW_SEED=N runs one" << first_of(report.faults);
  if (count < kEnough) return;
  EXPECT_GT(report.measured.restarts, 0) << "no tree has met the rung that keeps it out of deep minima";
  // A few in a thousand: whether there is one depends on how many are thrown.
  if (!report.leaps.empty())
    GTEST_SKIP() << "known failure: " << known_failure("random_trees") << "; today " << report.leaps.size()
                 << " of " << count << first_of(report.leaps);
}

TEST(RandomTrees, StayFiniteClosedAndWithoutFreeEnergyInFloat) {
  expect_no_faults<float>(0);
}

TEST(RandomTrees, StayFiniteClosedAndWithoutFreeEnergyInDouble) {
  expect_no_faults<double>(1);
}

TEST(RandomTrees, ThatOnceGainedEnergyDoNotGainAny) {
  for (const std::uint64_t seed : {268u, 1940u, 6317u, 7716u, 14031u}) expect_no_fault<double>(seed);
  for (const std::uint64_t seed : {2102u, 9005u}) expect_no_fault<float>(seed);
}

TEST(RandomTrees, AreValidAndTheSameForTheSameSeed) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Skeleton a = random_tree(seed), b = random_tree(seed);
    EXPECT_TRUE(validate(a).ok()) << "seed " << seed << ": " << validate(a).reason;
    ASSERT_EQ(a.joints.size(), b.joints.size());
    EXPECT_EQ(a.joints.back().mass, b.joints.back().mass);
    EXPECT_GE(a.dof_total(), 1);
    EXPECT_LE(a.dof_total(), 60);
  }
}

}  // namespace
}  // namespace sinew::study
