// Makes what a part of a plan still lacks.
#pragma once

#include <string>

#include "batch/plan.h"

namespace sinew::batch {

struct Run {
  int part = 1, parts = 1;  ///< --shard part/parts
  int jobs = 1;             ///< processes at once
  int tries = 3;            ///< starts of a unit that ends without a result, before it counts as failed
  long cpu_seconds = 3600;  ///< processor time of a unit; 0: no limit
  bool again = false;       ///< failed units are forgotten first
};

struct RunCounts {
  int done = 0, failed = 0;  ///< now, in this part
  int made = 0;              ///< by this run; the others were there
  double own_seconds = 0;    ///< processor time of this process …
  double work_seconds = 0;   ///< … and of those that it ran
};

/// Runs the units of a part that have no whole result. May be killed at any moment, run again, and run twice
/// at once. A unit whose process ends by a signal is started again; one that has been started `tries` times
/// without a result (also by runs that were killed with it) is reported as failed, and the rest goes on. The
/// error is of the whole: another program than that of the plan, a directory that cannot be written.
convert::Error run_part(const Plan& plan, const Run& how, RunCounts& out);

}  // namespace sinew::batch
