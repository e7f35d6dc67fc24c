#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "study/tables/count.h"
#include "study/tables/peers.h"
#include "study/tables/tables.h"

namespace sinew::study {
namespace {

constexpr const char* kMechanisms = SINEW_SOURCE_DIR "/assets/mechanisms";

struct Pairing {
  const char* formulation;
  const char* integrator;
};

/// Rows of Tables II and IV.
const std::vector<Pairing> kOpenRows = {{"DTR", "DE"},        {"DSR", "DE"},
                                        {"DTR", "ode15s"},    {"DSR", "ode15s"},
                                        {"DSR-JF", "ode15s"}, {"RR-JN", "ode15sR"},
                                        {"RR-JF", "ode15sR"}, {"RR-JN", "DASSL"},
                                        {"RR-JF", "DASSL"},   {"RR-JF", "DASSL-strict"},
                                        {"RR-JF", "RADAU5"}};
/// "Rz2": loops closed once per accepted step (index 2), as the paper has it; "Rz": in every evaluation.
const std::vector<Pairing> kClosedRows = {
    {"DSR-Rz", "DE"},         {"DSR-Rz", "ode15s"},   {"DSR-Rz-JF", "ode15s"},  {"RR-Rz-JN", "ode15sR"},
    {"RR-Rz-JF", "ode15sR"},  {"RR-Rz-JN", "DASSL"},  {"RR-Rz-JF", "DASSL"},    {"RR-Rz-JF", "DASSL-strict"},
    {"DSR-Rz2", "DE"},        {"DSR-Rz2", "ode15s"},  {"DSR-Rz2-JF", "ode15s"}, {"RR-Rz2-JN", "ode15sR"},
    {"RR-Rz2-JF", "ode15sR"}, {"RR-Rz2-JF", "DASSL"}, {"RR-Rz2-JF", "RADAU5"}};
/// Global formulations, beside both (global/cartesian_equations.h). DE takes no part in stiff mechanisms: its
/// stability would limit it, and counting it would take half an hour.
const std::vector<Pairing> kGlobalRows = {{"Cartesian-penalty", "DE"},
                                          {"Cartesian-multipliers", "DE"},
                                          {"Cartesian-penalty", "ode15s"},
                                          {"Cartesian-multipliers", "ode15s"}};

const std::vector<std::string> kOpenEvaluations = {"DTR", "DSR", "RR", "Cartesian-penalty",
                                                   "Cartesian-multipliers"},
                               kClosedEvaluations = {"DSR-Rz",
                                                     "RR-Rz",
                                                     "DSR-Rz2",
                                                     "RR-Rz2",
                                                     "Cartesian-penalty",
                                                     "Cartesian-multipliers"};

/// What the study knows, open chains first; the quick form takes those of Tables I to IV.
const std::vector<std::string> kOpen = {"fivebar_pendulum", "driver_nonstiff", "driver_stiff"},
                               kMoreOpen = {"fivebar_planar", "chain", "figure1"},
                               kClosed = {"bricard", "suspension_5ps", "suspension_mfs"},
                               kMoreClosed = {"bricard_slender",
                                              "driver_nonstiff_hands",
                                              "driver_stiff_hands",
                                              "nfourbar_2",
                                              "slider_crank",
                                              "four_bar",
                                              "andrews",
                                              "governor"};

std::vector<Pairing> rows_of(const StudyCase& c) {
  std::vector<Pairing> rows = c.closed() ? kClosedRows : kOpenRows;
  for (const Pairing& p : kGlobalRows)
    if (!c.stiff || std::string(p.integrator) != "DE") rows.push_back(p);
  return rows;
}

/// What of ours stands against the peers: for each its quickest form.
std::vector<Pairing> contenders(const StudyCase& c) {
  if (c.closed()) return {{"DSR-Rz2", "DE"}, {"RR-Rz2-JF", "ode15sR"}, {"RR-Rz2-JF", "DASSL"}};
  return {{"DTR", "DE"}, {"DSR", "DE"}, {"RR-JF", "ode15sR"}, {"RR-JF", "DASSL"}};
}

/// Runs of one mechanism at tolerances from 1e-2 down to 1e-11, each formulation and integrator that may win.
std::vector<SimulationRun> work_precision(const StudyCase& c, bool quick) {
  std::vector<SimulationRun> runs;
  for (const Pairing& p : contenders(c)) {
    if (c.stiff && std::string(p.integrator) == "DE") continue;  // stability would limit every one of them
    for (double exponent = -2; exponent >= -11; exponent -= quick ? 1 : 0.25) {
      SimulationRun m = measure(c, p.formulation, p.integrator, std::pow(10, exponent), 1);
      if (m.stopped.empty()) runs.push_back(m);
    }
  }
  return runs;
}

/// The quickest run within an error, measured again as often as the other was.
SimulationRun quickest_within(const StudyCase& c, const std::vector<SimulationRun>& runs,
                              const TrueError& error, int repeats) {
  const SimulationRun* best = nullptr;
  for (const SimulationRun& m : runs)
    if (m.error.within(error) && (!best || m.milliseconds < best->milliseconds)) best = &m;
  if (!best) return {};
  const std::size_t cut = best->method.find(" · ");
  return measure(c, best->method.substr(cut + std::string(" · ").size()), best->method.substr(0, cut),
                 best->tolerance, repeats);
}

class Study {
 public:
  Study(const TablesOptions& options, const std::function<void(int, int)>& progress, TablesResult& out)
      : options_(options), progress_(progress), out_(out), repeats_(options.quick ? 3 : 9), peers_(peers()) {
    directory_ = options.mechanisms.empty() ? kMechanisms : options.mechanisms;
    out_ = {};
    out_.tolerance = options.tolerance;
    out_.peers = !peers_.empty();
    out_.counted = can_count();
    for (const auto& [names, always] :
         {std::pair{&kOpen, true}, {&kMoreOpen, false}, {&kClosed, true}, {&kMoreClosed, false}})
      for (const std::string& name : *names)
        if (chosen(name, always)) names_.push_back(name);
    total_ = static_cast<int>(names_.size()) * 21 + 9;
  }

  std::string run() {
    if (names_.empty()) return directory_ + ": no mechanism of the study is there";
    for (const std::string& name : names_)
      if (std::string why = of_one(name); !why.empty()) return why;
    out_.chains = measure_chains(options_.quick, options_.recount, [this] { tick(); });
    out_.conclusions = conclusions_of(out_);
    if (progress_) progress_(total_, total_);
    return {};
  }

 private:
  bool chosen(const std::string& name, bool always) const {
    const auto& only = options_.only;
    if (!only.empty())
      always = std::find(only.begin(), only.end(), name) != only.end();
    else if (!options_.quick || !options_.mechanisms.empty())
      always = true;
    return always && std::filesystem::exists(directory_ + "/" + name + ".json");
  }

  void tick() {
    ++done_;
    if (progress_) progress_(std::min(done_, total_), total_);
  }

  /// Tolerances of the curves; among them the paper's.
  std::vector<double> tolerances() const {
    std::vector<double> all = {options_.tolerance};
    for (const double decades : options_.quick ? std::vector<double>{-1, 1} : std::vector<double>{-2, -1, 1})
      all.push_back(options_.tolerance * std::pow(10, decades));
    return all;
  }

  std::string of_one(const std::string& name) {
    StudyCase c;
    if (std::string why = load_case(directory_, name, c); !why.empty()) return why;
    const multibody::Model model(c.mechanism);
    out_.mechanisms.push_back(
        {name, model.size(), model.loop_rows, static_cast<int>(c.mechanism.bodies.size()), c.stiff});
    evaluate(c);
    simulate_rows(c);
    if (!peers_.empty()) compare(c, work_precision(c, options_.quick));
    return {};
  }

  void evaluate(const StudyCase& c) {
    std::vector<CountJob> jobs;
    for (const std::string& f : c.closed() ? kClosedEvaluations : kOpenEvaluations) {
      out_.evaluations.push_back({c.name, f, evaluation_time(c, f, 3 * repeats_)});
      jobs.push_back({c.name, f, "", 0});
    }
    const std::vector<double> counted = count(directory_, jobs, options_.recount);
    for (std::size_t i = 0; i < jobs.size(); ++i)
      out_.evaluations[out_.evaluations.size() - jobs.size() + i].instructions =
          counted[i] / evaluations_per_run(c.name);
    tick();
  }

  /// Global rows are slow: the penalty is spent at tight tolerances, and multipliers, always the dearer, are
  /// asked at the paper's only.
  bool worth_counting(const Pairing& row, double tolerance) const {
    return tolerance == options_.tolerance ||
           (tolerance > 0.05 * options_.tolerance && std::string(row.formulation) == "Cartesian-penalty");
  }

  void simulate_rows(const StudyCase& c) {
    std::vector<SimulationRun> runs;
    std::vector<CountJob> jobs;
    std::vector<std::size_t> run_of_job;
    for (const Pairing& row : rows_of(c)) {
      const bool global = std::string(row.formulation).starts_with("Cartesian");
      for (const double tolerance : tolerances()) {
        if (global && tolerance < 0.05 * options_.tolerance)
          continue;  // slow, and the penalty is spent there
        const bool papers = tolerance == options_.tolerance;
        runs.push_back(
            measure(c, row.formulation, row.integrator, tolerance, papers && !global ? repeats_ : 1));
        if (!runs.back().stopped.empty()) continue;
        run_of_job.push_back(runs.size() - 1);
        jobs.push_back({c.name, row.formulation, row.integrator, tolerance});
      }
      tick();
    }
    const std::vector<double> counted = count(directory_, jobs, options_.recount);
    for (std::size_t i = 0; i < jobs.size(); ++i) runs[run_of_job[i]].instructions = counted[i];
    for (const SimulationRun& run : runs) {
      out_.curves.push_back(run);
      if (run.tolerance == options_.tolerance) out_.simulations.push_back(run);
    }
    tick();
  }

  void compare(const StudyCase& c, const std::vector<SimulationRun>& ours) {
    for (const Peer& peer : peers_) {
      const SimulationRun theirs =
          peer.measure(c, options_.tolerance, c.stiff && !peer.stiff_too ? 1 : repeats_);
      tick();
      out_.comparisons.push_back({theirs, theirs.stopped.empty()
                                              ? quickest_within(c, ours, theirs.error, repeats_)
                                              : SimulationRun{}});
    }
  }

  const TablesOptions& options_;
  const std::function<void(int, int)>& progress_;
  TablesResult& out_;
  int repeats_, done_ = 0, total_ = 0;
  std::vector<Peer> peers_;
  std::string directory_;
  std::vector<std::string> names_;
};

}  // namespace

std::vector<std::string> TablesResult::names(bool closed) const {
  std::vector<std::string> out;
  for (const StudiedMechanism& m : mechanisms)
    if (m.closed() == closed) out.push_back(m.name);
  return out;
}

std::string run_tables(const TablesOptions& options, const std::function<void(int, int)>& progress,
                       TablesResult& out) {
  return Study(options, progress, out).run();
}

const SimulationRun* find(const TablesResult& result, const std::string& mechanism,
                          const std::string& method) {
  for (const SimulationRun& m : result.simulations)
    if (m.mechanism == mechanism && m.method == method) return &m;
  return nullptr;
}

const SimulationRun* best_simulation(const TablesResult& result, const std::string& mechanism) {
  const auto cost = [&](const SimulationRun& m) { return result.counted ? m.instructions : m.milliseconds; };
  const SimulationRun* best = nullptr;
  for (const SimulationRun& m : result.simulations)
    if (m.mechanism == mechanism && m.stopped.empty() && (!best || cost(m) < cost(*best))) best = &m;
  return best;
}

const EvaluationCost* evaluation(const TablesResult& result, const std::string& mechanism,
                                 const std::string& formulation) {
  for (const EvaluationCost& e : result.evaluations)
    if (e.mechanism == mechanism && e.formulation == formulation) return &e;
  return nullptr;
}

}  // namespace sinew::study
