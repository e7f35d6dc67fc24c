#include "batch/run.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <map>

#include "batch/processes.h"
#include "batch/results.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using Clock = std::chrono::steady_clock;

/// One run of one part.
class Runner {
 public:
  Runner(const Plan& plan, const Run& how) : plan_(plan), how_(how) {}

  Error run(RunCounts& out);

 private:
  struct Attempt {
    fs::path work;
    Clock::time_point begin;
  };

  Error collect();
  /// Starts all that has no result, once. False: nothing is left.
  bool pass(RunCounts& out);
  /// What can be said without running it: it was tried too often, or its input has changed.
  bool is_hopeless(const Unit& unit);
  std::vector<std::string> command(std::size_t n);
  void finish(const Finished& process, RunCounts& out);
  void keep(const Unit& unit, const fs::path& work, const std::string& state, const std::string& error,
            double seconds);

  const Plan& plan_;
  const Run& how_;
  std::vector<Unit> units_;
  std::vector<bool> settled_;  ///< has a result, whose bytes were compared or made here
  std::map<std::size_t, Attempt> attempts_;
  Error fault_;  ///< of the whole
};

Error Runner::collect() {
  for (const int shard : shards_of_part(plan_, how_.part, how_.parts))
    if (Error error = read_shard(plan_, shard, units_)) return error;
  settled_.assign(units_.size(), false);
  if (how_.again)
    for (const Unit& unit : units_)
      if (find_result(plan_, unit, false).state == "failed") drop_result(plan_, unit);
  return {};
}

void Runner::keep(const Unit& unit, const fs::path& work, const std::string& state, const std::string& error,
                  double seconds) {
  if (Error fault = keep_result(plan_, unit, work, state, error, seconds); fault && !fault_) fault_ = fault;
}

bool Runner::is_hopeless(const Unit& unit) {
  std::string why;
  if (const int started = tries(plan_, unit); started >= how_.tries)
    why = unit.name + ": started " + std::to_string(started) + " times without a result";
  else if (key_of(unit, plan_.program) != unit.key)
    why = unit.input + ": has changed since it was planned";
  else
    return false;
  fs::path work;
  if (Error error = make_work(plan_, unit, work))
    fault_ = error;
  else
    keep(unit, work, "failed", why, 0);
  return true;
}

std::vector<std::string> Runner::command(std::size_t n) {
  const Unit& unit = units_[n];
  Attempt& attempt = attempts_[n];
  attempt.begin = Clock::now();
  if (Error error = make_work(plan_, unit, attempt.work)) fault_ = error;
  if (Error error = note_try(plan_, unit)) fault_ = error;
  const fs::path files = attempt.work / "files";
  std::vector<std::string> words = {unit.kind};
  if (!unit.input.empty()) words.push_back(unit.input);
  words.insert(words.end(), unit.arguments.begin(), unit.arguments.end());
  words.insert(
      words.end(),
      {"--quiet", "-o", unit.kind == "study" ? files.string() : (files / ("out" + unit.ending)).string()});
  return words;
}

void Runner::finish(const Finished& process, RunCounts& out) {
  const Unit& unit = units_[process.item];
  const Attempt attempt = attempts_[process.item];
  attempts_.erase(process.item);
  const double seconds = std::chrono::duration<double>(Clock::now() - attempt.begin).count();
  std::error_code code;
  // 3: a study on a busy machine, whose files are there.
  const bool done = process.succeeded() ||
                    (unit.kind == "study" && WIFEXITED(process.status) && WEXITSTATUS(process.status) == 3);
  if (process.status == -1 || WIFSIGNALED(process.status)) {  // tried again, or hopeless in the next pass
    fs::remove_all(attempt.work, code);
    return;
  }
  ++out.made;
  std::string why = done ? "" : reason(process, "sinew " + unit.kind);
  for (std::size_t at; (at = why.find(attempt.work.string())) != std::string::npos;)
    why.replace(at, attempt.work.string().size(), "OUTPUT");
  keep(unit, attempt.work, done ? "done" : "failed", why, seconds);
  settled_[process.item] = true;
}

bool Runner::pass(RunCounts& out) {
  std::vector<std::size_t> left;
  std::map<std::string, std::size_t> keys;  // of equal units one is made
  for (std::size_t n = 0; n < units_.size() && !fault_; ++n) {
    settled_[n] = settled_[n] || !find_result(plan_, units_[n], true).state.empty() || is_hopeless(units_[n]);
    if (settled_[n]) continue;
    if (keys.emplace(units_[n].key, n).second) left.push_back(n);
  }
  if (left.empty() || fault_) return false;
  run_processes(
      {how_.jobs, plan_.directory / "work", how_.cpu_seconds, "batch: unit"}, left,
      [&](std::size_t n) { return command(n); }, [&](const Finished& process) { finish(process, out); });
  return true;
}

double processor_seconds(int whose) {
  rusage used{};
  getrusage(whose, &used);
  return double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

Error Runner::run(RunCounts& out) {
  if (program_digest() != plan_.program)
    return {plan_.directory.string() +
            ": was planned with another build of sinew; results of two are not mixed"};
  if (Error error = collect()) return error;
  std::error_code code;
  fs::create_directories(plan_.directory / "work", code);
  if (code) return {(plan_.directory / "work").string() + ": cannot be made: " + code.message()};
  clear_work(plan_);
  while (pass(out)) {
  }
  if (fault_) return fault_;
  for (const Unit& unit : units_) ++(find_result(plan_, unit, false).state == "done" ? out.done : out.failed);
  out.own_seconds = processor_seconds(RUSAGE_SELF);
  out.work_seconds = processor_seconds(RUSAGE_CHILDREN);
  return {};
}

}  // namespace

Error run_part(const Plan& plan, const Run& how, RunCounts& out) {
  out = {};
  return Runner(plan, how).run(out);
}

}  // namespace sinew::batch
