#include "batch/slurm.h"

#include <sys/wait.h>

#include <algorithm>
#include <map>
#include <set>

#include "batch/processes.h"
#include "batch/status.h"
#include "cli/files.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

/// What a command of a shell prints; its code.
int output_of(const std::string& command, std::string& out) {
  out.clear();
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return 127;
  char block[4096];
  for (std::size_t n; (n = fread(block, 1, sizeof block, pipe)) > 0;) out.append(block, n);
  const int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/// "1-3,7" of 1, 2, 3 and 7.
std::string ranges(const std::set<int>& numbers) {
  std::string out;
  for (auto at = numbers.begin(); at != numbers.end();) {
    const int first = *at;
    int last = first;
    while (++at != numbers.end() && *at == last + 1) ++last;
    out +=
        (out.empty() ? "" : ",") + std::to_string(first) + (last > first ? "-" + std::to_string(last) : "");
  }
  return out;
}

std::string head(const Plan& plan, const Submit& how, const std::string& name) {
  const std::string directory = fs::absolute(plan.directory).lexically_normal();
  std::string out =
      "#!/bin/sh\n#SBATCH --job-name=" + name +
      "\n#SBATCH --requeue\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=" + std::to_string(how.jobs) + "\n";
  for (const std::string& option : how.options) out += "#SBATCH " + option + "\n";
  return out + "run=" + quoted(directory) + "\n";
}

/// `sinew batch …` with the plan's directory.
std::string command(const std::string& words) {
  std::error_code unknown;
  const std::string program = fs::read_symlink("/proc/self/exe", unknown);
  return quoted(program) + " batch " + words;
}

std::string array_script(const Plan& plan, const Submit& how, int parts, const std::string& tasks) {
  const std::string log = (fs::absolute(plan.directory) / "slurm" / "%A_%a.log").lexically_normal();
  std::string out = head(plan, how, "sinew-batch");
  out.insert(out.find("run="), "#SBATCH --array=" + tasks + "\n#SBATCH --output=" + log + "\n");
  return out +
         "# Failed units (1) are results. A shard whose process dies is run again here; one whose node dies, "
         "by Slurm.\n"
         "for try in " +
         [&] {
           std::string numbers;
           for (int k = 1; k <= how.tries; ++k) numbers += (k > 1 ? " " : "") + std::to_string(k);
           return numbers;
         }() +
         "; do\n  " +
         command("run \"$run\" --shard \"$SLURM_ARRAY_TASK_ID/" + std::to_string(parts) + "\" -q -j " +
                 std::to_string(how.jobs) + " --tries " + std::to_string(how.tries)) +
         "\n  code=$?\n  [ $code -le 1 ] && exit 0\ndone\nexit $code\n";
}

std::string merge_script(const Plan& plan, const Submit& how) {
  const std::string log = (fs::absolute(plan.directory) / "slurm" / "merge_%j.log").lexically_normal();
  std::string out = head(plan, how, "sinew-merge");
  out.insert(out.find("run="), "#SBATCH --output=" + log + "\n");
  return out + "# What tasks have not finished is run here.\n" +
         command("run \"$run\" -q -j " + std::to_string(how.jobs) + " --tries " + std::to_string(how.tries)) +
         "\n" + command("merge \"$run\"") + "\n";
}

/// Submits a script; the job's id.
Error sbatch(const std::string& arguments, std::string& id) {
  if (output_of("command -v sbatch", id) != 0)
    return {
        "sbatch is not installed: the scripts are written, and `sinew batch run RUN -j N` runs the same on "
        "this machine"};
  const int code = output_of("sbatch --parsable " + arguments + " 2>&1", id);
  std::string line = id.substr(0, id.find('\n'));
  if (code != 0) return {"sbatch refused: " + line};
  id = line.substr(0, line.find(';'));  // ID or ID;CLUSTER
  return {};
}

}  // namespace

Error submit(const Plan& plan, const Submit& how, Submitted& out) {
  out = {};
  Status status;
  if (Error error = read_status(plan, status)) return error;
  const int parts = std::min(plan.shards, how.array_limit);
  std::set<int> tasks;
  for (const int shard : status.open) tasks.insert((shard - 1) % parts + 1);
  out.tasks = ranges(tasks);
  const fs::path directory = plan.directory / "slurm";
  std::error_code code;
  fs::create_directories(directory, code);
  const std::string array = (directory / "array.sh").string(), merge = (directory / "merge.sh").string();
  if (Error error = cli::write_atomically(array, array_script(plan, how, parts, out.tasks))) return error;
  if (Error error = cli::write_atomically(merge, merge_script(plan, how))) return error;
  if (how.dry_run) return {};
  if (!out.tasks.empty())
    if (Error error = sbatch(quoted(array), out.array)) return error;
  const std::string after = out.array.empty() ? "" : "--dependency=afterany:" + out.array + " ";
  if (Error error = sbatch(after + quoted(merge), out.merge)) return error;
  return cli::write_atomically((directory / "jobs.json").string(),
                               cli::json_text({{"array", out.array}, {"merge", out.merge}}) + "\n");
}

json read_queue(const Plan& plan) {
  json states = json::object(), jobs;
  if (cli::read_json((plan.directory / "slurm" / "jobs.json").string(), jobs)) return states;
  std::string ids;
  for (const char* which : {"array", "merge"}) {
    const std::string id = jobs.value(which, "");
    const bool number = !id.empty() && id.find_first_not_of("0123456789") == std::string::npos;
    if (number) ids += (ids.empty() ? "" : ",") + id;
  }
  if (ids.empty()) return states;
  std::map<std::string, std::string> by_task;  // squeue knows what is in the queue now, sacct what has been
  for (const std::string& command :
       {"sacct -n -X -P -o JobID,State -j " + ids, "squeue -h -r -o '%i|%T' -j " + ids}) {
    std::string text;
    if (output_of(command + " 2>/dev/null", text) != 0) continue;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (const std::size_t bar = line.find('|'); bar != std::string::npos)
        by_task[line.substr(0, bar)] = line.substr(bar + 1, line.find(' ', bar) - bar - 1);
  }
  for (const auto& [task, state] : by_task) states[state] = states.value(state, 0) + 1;
  return states;
}

}  // namespace sinew::batch
