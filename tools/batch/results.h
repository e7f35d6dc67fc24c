// What units made, by their keys:
//
//     RUN/results/ab/KEY/record.json   {"state": "done" or "failed", "error", "files": [[name, bytes, digest]
//     …]} RUN/results/ab/KEY/files/…       the output: out.sinew, out.mp4, out_0001.png …, or a study's files
//     RUN/results/ab/KEY/time.json     {"seconds"}
//     RUN/tries/ab/KEY                 a line for every start
//
// A result is a directory that appears with one rename, complete and flushed to disk. Who comes second finds
// it and drops his own: no locks.
#pragma once

#include <filesystem>
#include <string>

#include "batch/plan.h"

namespace sinew::batch {

struct Result {
  std::string state;  ///< "done", "failed"; "" where there is none, or a damaged one
  std::string error;
  nlohmann::json files;  ///< of the record
  double seconds = 0;
};

std::filesystem::path result_directory(const Plan& plan, const Unit& unit);

/// `whole`: the files' bytes are compared with their digests, else only their sizes.
Result find_result(const Plan& plan, const Unit& unit, bool whole);

/// Makes `work` (with `files` in it, where the state is "done") the result.
convert::Error keep_result(const Plan& plan, const Unit& unit, const std::filesystem::path& work,
                           const std::string& state, const std::string& error, double seconds);

/// Removes a result and what is known of its tries.
void drop_result(const Plan& plan, const Unit& unit);

/// How often a unit was started; note_try() adds one.
int tries(const Plan& plan, const Unit& unit);
convert::Error note_try(const Plan& plan, const Unit& unit);

/// A new directory for one try, of this process on this machine.
convert::Error make_work(const Plan& plan, const Unit& unit, std::filesystem::path& out);

/// Removes the work of processes of this machine that have ended.
void clear_work(const Plan& plan);

}  // namespace sinew::batch
