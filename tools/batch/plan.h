// An immutable plan: what is to be made, in shards that machines take.
//
//     RUN/plan.json         what all shards have in common; written last, so a plan is whole or not there
//     RUN/shards/N.jsonl    the units of shard N (from 1), one a line
//     RUN/results/ab/KEY/   what was made (results.h)
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "batch/manifest.h"

namespace sinew::batch {

struct Plan {
  std::filesystem::path directory;  ///< RUN
  std::string program, digest;      ///< of the programs; of all shards
  int shards = 0;
  std::size_t units = 0;
  double seconds = 0;  ///< estimate of all, on one core
};

/// Writes a plan. Where the directory holds the same already nothing is done; another one is refused.
convert::Error write_plan(const Manifest& manifest, const std::string& program,
                          const std::filesystem::path& directory, Plan& out);

convert::Error open_plan(const std::filesystem::path& directory, Plan& out);

/// The units of one shard, 1 … plan.shards.
convert::Error read_shard(const Plan& plan, int shard, std::vector<Unit>& out);

/// Which of the plan's shards part k of N has (k from 1): every N-th.
std::vector<int> shards_of_part(const Plan& plan, int k, int n);

/// "3/8". False: it is none.
bool read_part(const std::string& text, int& k, int& n);

}  // namespace sinew::batch
