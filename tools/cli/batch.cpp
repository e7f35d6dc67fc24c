#include "cli/batch.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "batch/merge.h"
#include "batch/plan.h"
#include "batch/status.h"
#include "cli/files.h"
#include "cli/terminal.h"

namespace sinew::cli {
namespace {

using convert::Error;
using nlohmann::json;

Error failed_units(std::size_t failed) {
  if (failed == 0) return {};
  return {std::to_string(failed) + (failed == 1 ? " unit" : " units") + " failed"};
}

std::string list(const std::vector<int>& shards) {
  constexpr std::size_t kShown = 20;
  std::string out;
  for (std::size_t k = 0; k < std::min(shards.size(), kShown); ++k)
    out += (k > 0 ? ", " : "") + std::to_string(shards[k]);
  return out + (shards.size() > kShown ? ", …" : "");
}

}  // namespace

void BatchCommand::add(CLI::App& app) {
  app.require_subcommand(1);
  const auto command = [&](const char* name, const std::string& words) {
    CLI::App* made = app.add_subcommand(name, words);
    made->add_flag("--json", json_output, "the report on standard output as JSON");
    return made;
  };
  const auto of_run = [&](CLI::App* c) {
    c->add_option("run", directory, "directory of the plan")->required()->type_name("DIR");
  };
  const auto jobs = [](CLI::App* c, int& at_once, int& tries) {
    c->add_option("-j,--jobs", at_once, "processes at once")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    c->add_option("--tries", tries, "starts of what ends without a result, before it counts as failed")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
  };
  plan_ = command("plan",
                  "finds all inputs of a manifest and writes the plan: shards of units\n"
                  "Example: sinew batch plan characters.json -o out/run");
  plan_->add_option("manifest", manifest, "what is wanted, JSON (see tools/batch/README.md)")
      ->required()
      ->type_name("FILE");
  plan_->add_option("-o,--output", directory, "directory of the plan and of all that it makes")
      ->required()
      ->type_name("DIR");
  run_ = command("run", "makes what is still lacking\nExample: sinew batch run out/run -j 8");
  of_run(run_);
  run_->add_option("--shard", part, "one part of the shards: the K-th of N")
      ->type_name("K/N")
      ->default_str("all");
  jobs(run_, run_options.jobs, run_options.tries);
  run_->add_option("--cpu-limit", run_options.cpu_seconds, "processor time of a unit, s; 0: none")
      ->check(CLI::Range(0L, 10000000L))
      ->capture_default_str();
  run_->add_flag("--again", run_options.again, "units that failed are tried anew");
  status_ = command("status", "how far a plan is\nExample: sinew batch status out/run");
  of_run(status_);
  merge_ =
      command("merge", "all outputs under their names, and a report\nExample: sinew batch merge out/run");
  of_run(merge_);
  merge_->add_option("-o,--output", output, "directory to write")
      ->type_name("DIR")
      ->default_str("RUN/merged");
  submit_ = command("submit",
                    "to Slurm: an array job for what is lacking, and a job that merges after it\n"
                    "Example: sinew batch submit out/run --sbatch=--partition=farm --sbatch=--time=30");
  of_run(submit_);
  jobs(submit_, submit_options.jobs, submit_options.tries);
  submit_->add_option("--sbatch", submit_options.options, "an option for sbatch; may stand several times")
      ->allow_extra_args(false)
      ->default_str("none");
  submit_
      ->add_option("--array-limit", submit_options.array_limit,
                   "tasks of the array at most; they share more shards")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  submit_->add_flag("--dry-run", submit_options.dry_run, "write the scripts, submit nothing");
}

Error BatchCommand::run() {
  if (plan_->parsed()) return plan();
  batch::Plan plan;
  if (Error error = batch::open_plan(directory, plan)) return error;
  if (run_->parsed()) return run_shards(plan);
  if (status_->parsed()) return status(plan);
  return merge_->parsed() ? merge(plan) : submit(plan);
}

Error BatchCommand::plan() const {
  batch::Manifest wanted;
  batch::Plan plan;
  const std::string program = batch::program_digest();
  if (Error error = batch::read_manifest(manifest, program, wanted)) return error;
  if (Error error = batch::write_plan(wanted, program, directory, plan)) return error;
  if (json_output)
    std::puts(json_text({{"run", directory},
                         {"units", plan.units},
                         {"shards", plan.shards},
                         {"estimated_seconds", plan.seconds}})
                  .c_str());
  else
    say("%s: %zu units in %d shards, about %.0f s of work\n", directory.c_str(), plan.units, plan.shards,
        plan.seconds);
  return {};
}

Error BatchCommand::run_shards(const batch::Plan& plan) {
  if (!part.empty() && !batch::read_part(part, run_options.part, run_options.parts))
    return {"--shard: '" + part + "' is not K/N"};
  batch::RunCounts counts;
  if (Error error = batch::run_part(plan, run_options, counts)) {
    exit_code = kNotFinished;
    return error;
  }
  if (json_output)
    std::puts(json_text({{"done", counts.done},
                         {"failed", counts.failed},
                         {"made_now", counts.made},
                         {"own_processor_seconds", counts.own_seconds},
                         {"work_processor_seconds", counts.work_seconds}})
                  .c_str());
  else
    say("%d done, %d failed; %d of them now, in %.1f s of processor time\n", counts.done, counts.failed,
        counts.made, counts.work_seconds);
  return failed_units(static_cast<std::size_t>(counts.failed));
}

Error BatchCommand::status(const batch::Plan& plan) {
  batch::Status now;
  if (Error error = batch::read_status(plan, now)) return error;
  const json queue = batch::read_queue(plan);
  if (json_output) {
    json failures = json::array();
    for (const auto& [name, why] : now.failures) failures.push_back({{"name", name}, {"error", why}});
    std::puts(json_text({{"units", plan.units},
                         {"done", now.done},
                         {"failed", now.failed},
                         {"left", now.left},
                         {"shards", plan.shards},
                         {"open_shards", now.open},
                         {"seconds", now.seconds},
                         {"by_kind", now.by_kind},
                         {"failures", failures},
                         {"queue", queue}})
                  .c_str());
  } else {
    for (const auto& [name, why] : now.failures)
      say("%s      %s: %s\n", styled("FAILED", Style::kRed, STDOUT_FILENO).c_str(), name.c_str(),
          why.c_str());
    say("%zu done, %zu failed, %zu left of %zu; %zu of %d shards are open\n", now.done, now.failed, now.left,
        plan.units, now.open.size(), plan.shards);
    for (const auto& [state, count] : queue.items()) say("slurm: %d %s\n", count.get<int>(), state.c_str());
  }
  if (now.left > 0) {
    exit_code = kNotFinished;
    return {directory + ": not finished"};
  }
  return failed_units(now.failed);
}

Error BatchCommand::merge(const batch::Plan& plan) {
  const std::string to = output.empty() ? directory + "/merged" : output;
  batch::Merged merged;
  if (Error error = batch::merge_results(plan, to, merged)) return error;
  if (!merged.open.empty()) {
    if (json_output) std::puts(json_text({{"open_shards", merged.open}}).c_str());
    exit_code = kNotFinished;
    return {directory + ": nothing merged, shards are not finished: " + list(merged.open)};
  }
  if (json_output)
    std::puts(json_text({{"output", to}, {"done", merged.done}, {"failed", merged.failed}}).c_str());
  else
    say("%s: %zu done, %zu failed; report.json says which\n", to.c_str(), merged.done, merged.failed);
  return failed_units(merged.failed);
}

Error BatchCommand::submit(const batch::Plan& plan) const {
  batch::Submitted jobs;
  if (Error error = batch::submit(plan, submit_options, jobs)) return error;
  if (json_output)
    std::puts(
        json_text({{"tasks", jobs.tasks}, {"array_job", jobs.array}, {"merge_job", jobs.merge}}).c_str());
  else if (submit_options.dry_run)
    say("%s/slurm/array.sh and merge.sh: tasks %s\n", directory.c_str(),
        jobs.tasks.empty() ? "none" : jobs.tasks.c_str());
  else
    say("array job %s, tasks %s; merge job %s\n", jobs.array.empty() ? "none" : jobs.array.c_str(),
        jobs.tasks.empty() ? "none" : jobs.tasks.c_str(), jobs.merge.c_str());
  return {};
}

}  // namespace sinew::cli
