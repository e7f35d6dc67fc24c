// A plan as jobs of Slurm, which schedules, queues and moves: nothing here does.
#pragma once

#include <string>
#include <vector>

#include "batch/run.h"

namespace sinew::batch {

struct Submit {
  int jobs = 1;                      ///< processes at once in a task, which asks for as many processors
  int tries = 3;                     ///< of a shard whose process dies in a task, and of a unit
  int array_limit = 1000;            ///< tasks at most; more shards share them (Slurm's MaxArraySize is 1001)
  std::vector<std::string> options;  ///< further lines for sbatch ("--partition=farm")
  bool dry_run = false;              ///< writes the scripts, submits nothing
};

struct Submitted {
  std::string tasks;         ///< of the array, "1-3,7"; "" where nothing is left to run
  std::string array, merge;  ///< Slurm's job ids
};

/// Writes RUN/slurm/array.sh and merge.sh, and submits them with sbatch: an array of tasks that run what is
/// left, and a job after it (afterany) that runs what tasks have not finished, and merges. What is submitted
/// is noted for read_queue().
convert::Error submit(const Plan& plan, const Submit& how, Submitted& out);

/// {"PENDING": 3, "RUNNING": 2, …}: states of the submitted tasks, from squeue, and from sacct where there is
/// accounting. Empty: nothing was submitted, or Slurm is not there.
nlohmann::json read_queue(const Plan& plan);

}  // namespace sinew::batch
