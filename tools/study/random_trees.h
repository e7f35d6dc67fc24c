// Trees nobody would build: 1–60 degrees of freedom, every joint type, masses from 1e-4 to 1e4 kg, thrown on
// a floor. What a seed makes never changes, so a seed is a bug report.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "study/stage.h"

namespace sinew::study {

Skeleton random_tree(std::uint64_t seed);

/// What went wrong with a tree, in words, or empty.
struct TreeFaults {
  std::string fault;  ///< NaN, open joints, energy without work
  std::string leap;   ///< a step's way needs more energy than there is; energies are not judged then
};

/// Steps the tree of a seed 100 times with a step (1/240 … 1/30 s) and a throw that the seed also decides.
template <class T>
TreeFaults faults_of_tree(std::uint64_t seed, Measurement& measured);

struct RandomTreesReport {
  int count = 0;
  std::vector<std::string> faults;  ///< "seed N: what", in the order of seeds
  std::vector<std::string> leaps;   ///< as faults
  Measurement measured;
};

/// Seeds first … first + count − 1, on so many threads.
template <class T>
RandomTreesReport run_random_trees(std::uint64_t first, int count, int threads);

}  // namespace sinew::study
