// Runs what count.cpp lists, for callgrind to count: `sinew_tables_twin DIRECTORY LIST`.
#include <cstdio>
#include <fstream>
#include <functional>

#include "study/tables/count.h"
#include "study/tables/measure.h"

/// Counting begins and ends with this function.
extern "C" __attribute__((noinline)) void sinew_counted(const std::function<void()>* work);
extern "C" __attribute__((noinline)) void sinew_counted(const std::function<void()>* work) {
  (*work)();
  asm volatile("");  // not the last call: a jump would end the counting
}

namespace {

using sinew::study::CountJob;
using sinew::study::StudyCase;

/// One call of `sinew_counted` per job, also for one that cannot be run.
void run(const CountJob& job, const StudyCase& c) {
  std::function<void()> work = [] {};
  if (job.integrator.empty()) {
    if (const auto evaluations = sinew::study::evaluations_of(c, job.formulation); evaluations.run) {
      evaluations.run();  // what the first one allocates is not counted
      work = evaluations.run;
    }
  } else {
    work = sinew::study::simulation_of(c, job.formulation, job.integrator, job.tolerance);
  }
  sinew_counted(&work);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: sinew_tables_twin DIRECTORY LIST\n", stderr);
    return 2;
  }
  std::ifstream list(argv[2]);
  StudyCase c;
  for (std::string line; std::getline(list, line);) {
    const CountJob job = sinew::study::job_of(line);
    if (job.mechanism != c.name && !sinew::study::load_mechanism_only(argv[1], job.mechanism, c).empty())
      return 1;
    run(job, c);
  }
  return 0;
}
