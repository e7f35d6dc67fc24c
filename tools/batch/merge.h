// The results of a plan under the names of its units.
#pragma once

#include "batch/plan.h"

namespace sinew::batch {

struct Merged {
  std::size_t done = 0, failed = 0;
  std::vector<int> open;  ///< shards with units that have no whole result: nothing was written
};

/// Writes every output to `directory` under its unit's name, and report.json: a row for each unit, in the
/// order of the manifest, with its files' sizes and digests, or why it failed. The same bytes whatever the
/// number of machines, shards and tries. The directory is replaced as a whole, once all is there; files are
/// hard links where that is possible.
convert::Error merge_results(const Plan& plan, const std::filesystem::path& directory, Merged& out);

}  // namespace sinew::batch
