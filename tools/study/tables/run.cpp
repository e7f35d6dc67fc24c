#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "study/tables/peers.h"
#include "study/tables/tables.h"

namespace sinew::study {
namespace {

struct Pairing {
  const char* formulation;
  const char* integrator;
};

/// Rows of Tables II and IV.
const std::vector<Pairing> kOpenRows = {{"DTR", "DE"},        {"DSR", "DE"},        {"DTR", "ode15s"},
                                        {"DSR", "ode15s"},    {"DSR-JF", "ode15s"}, {"RR-JN", "ode15sR"},
                                        {"RR-JF", "ode15sR"}, {"RR-JN", "DASSL"},   {"RR-JF", "DASSL"}};
const std::vector<Pairing> kClosedRows = {
    {"DSR-Rz", "DE"},        {"DSR-Rz", "ode15s"},  {"DSR-Rz-JF", "ode15s"}, {"RR-Rz-JN", "ode15sR"},
    {"RR-Rz-JF", "ode15sR"}, {"RR-Rz-JN", "DASSL"}, {"RR-Rz-JF", "DASSL"}};

/// What of ours stands against the peers: for each its quickest form.
std::vector<Pairing> contenders(const StudyCase& c) {
  if (c.closed()) return {{"DSR-Rz", "DE"}, {"RR-Rz-JF", "ode15sR"}, {"RR-Rz-JF", "DASSL"}};
  return {{"DTR", "DE"}, {"DSR", "DE"}, {"RR-JF", "ode15sR"}, {"RR-JF", "DASSL"}};
}

/// Runs of one mechanism at tolerances from 1e-2 down to 1e-11, each formulation and integrator that may win.
std::vector<Measurement> work_precision(const StudyCase& c, bool quick) {
  std::vector<Measurement> runs;
  for (const Pairing& p : contenders(c)) {
    if (c.stiff && std::string(p.integrator) == "DE") continue;  // stability would limit every one of them
    for (double exponent = -2; exponent >= -11; exponent -= quick ? 1 : 0.25) {
      Measurement m = measure(c, p.formulation, p.integrator, std::pow(10, exponent), 1);
      if (m.stopped.empty()) runs.push_back(m);
    }
  }
  return runs;
}

/// The quickest run within an error, measured again as often as the other was.
Measurement quickest_within(const StudyCase& c, const std::vector<Measurement>& runs, const TrueError& error,
                            int repeats) {
  const Measurement* best = nullptr;
  for (const Measurement& m : runs)
    if (m.error.within(error) && (!best || m.milliseconds < best->milliseconds)) best = &m;
  if (!best) return {};
  const std::size_t cut = best->method.find(" · ");
  return measure(c, best->method.substr(cut + std::string(" · ").size()), best->method.substr(0, cut),
                 best->tolerance, repeats);
}

constexpr const char* kMechanisms = SINEW_SOURCE_DIR "/assets/mechanisms";

/// Names of those files that the directory has.
std::vector<std::string> present(const std::string& directory, const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names)
    if (std::filesystem::exists(directory + "/" + name + ".json")) out.push_back(name);
  return out;
}

class Study {
 public:
  Study(const TablesOptions& options, const std::function<void(int, int)>& progress, TablesResult& out)
      : options_(options), progress_(progress), out_(out), repeats_(options.quick ? 3 : 9), peers_(peers()) {
    directory_ = options.mechanisms.empty() ? kMechanisms : options.mechanisms;
    out_ = {};
    out_.tolerance = options.tolerance;
    out_.peers = !peers_.empty();
    out_.open =
        present(directory_, {"fivebar_pendulum", "driver_nonstiff", "driver_stiff", "chain", "figure1"});
    out_.closed = present(directory_, {"bricard", "suspension_5ps", "suspension_mfs", "four_bar"});
    compared_closed_ = out_.closed;
    for (const std::string& name : present(directory_, {"driver_nonstiff_hands", "driver_stiff_hands"}))
      compared_closed_.push_back(name);
    if (peers_.empty()) compared_closed_ = out_.closed;
    const int compared = static_cast<int>(out_.open.size() + compared_closed_.size());
    total_ = static_cast<int>(out_.open.size() * (3 + kOpenRows.size()) +
                              out_.closed.size() * (2 + kClosedRows.size())) +
             compared * static_cast<int>(1 + peers_.size()) + (options.quick ? 6 : 8);
  }

  std::string run() {
    if (out_.open.empty() && out_.closed.empty()) return directory_ + ": no mechanism of the study is there";
    for (const std::string& name : out_.open)
      if (std::string why = of_one(name, {"DTR", "DSR", "RR"}, kOpenRows, true); !why.empty()) return why;
    for (const std::string& name : compared_closed_) {
      const bool tabled = std::find(out_.closed.begin(), out_.closed.end(), name) != out_.closed.end();
      if (std::string why = of_one(name, {"DSR-Rz", "RR-Rz"}, kClosedRows, tabled); !why.empty()) return why;
    }
    out_.chains = measure_chains(options_.quick, [this] { tick(); });
    out_.conclusions = conclusions_of(out_);
    return {};
  }

 private:
  void tick() {
    ++done_;
    if (progress_) progress_(std::min(done_, total_), total_);
  }

  std::string of_one(const std::string& name, const std::vector<std::string>& formulations,
                     const std::vector<Pairing>& rows, bool tabled) {
    StudyCase c;
    if (std::string why = load_case(directory_, name, c); !why.empty()) return why;
    for (const std::string& f : tabled ? formulations : std::vector<std::string>{}) {
      const auto kind = f == "DTR"             ? multibody::Formulation::kDtr
                        : f.starts_with("DSR") ? multibody::Formulation::kDsr
                                               : multibody::Formulation::kRr;
      out_.evaluations.push_back({name, f, evaluation_time(c, kind, 3 * repeats_)});
      tick();
    }
    for (const Pairing& row : tabled ? rows : std::vector<Pairing>{}) {
      out_.simulations.push_back(measure(c, row.formulation, row.integrator, options_.tolerance, repeats_));
      tick();
    }
    const std::vector<Measurement> ours = work_precision(c, options_.quick);
    tick();
    if (tabled && !c.stiff) set_against_implicit(c, ours);
    compare(c, ours);
    return {};
  }

  void set_against_implicit(const StudyCase& c, std::vector<Measurement> runs) {
    const Measurement explicit_run =
        measure(c, c.closed() ? "DSR-Rz" : "DTR", "DE", options_.tolerance, repeats_);
    std::erase_if(runs, [](const Measurement& m) { return m.method.starts_with("DE"); });
    out_.explicit_or_implicit.push_back(
        {explicit_run, quickest_within(c, runs, explicit_run.error, repeats_)});
  }

  void compare(const StudyCase& c, const std::vector<Measurement>& ours) {
    for (const Peer& peer : peers_) {
      const Measurement theirs =
          peer.measure(c, options_.tolerance, c.stiff && !peer.stiff_too ? 1 : repeats_);
      tick();
      out_.comparisons.push_back({theirs, theirs.stopped.empty()
                                              ? quickest_within(c, ours, theirs.error, repeats_)
                                              : Measurement{}});
    }
  }

  const TablesOptions& options_;
  const std::function<void(int, int)>& progress_;
  TablesResult& out_;
  int repeats_, done_ = 0, total_ = 0;
  std::vector<Peer> peers_;
  std::string directory_;
  std::vector<std::string> compared_closed_;
};

}  // namespace

std::string run_tables(const TablesOptions& options, const std::function<void(int, int)>& progress,
                       TablesResult& out) {
  return Study(options, progress, out).run();
}

const Measurement* find(const TablesResult& result, const std::string& mechanism, const std::string& method) {
  for (const Measurement& m : result.simulations)
    if (m.mechanism == mechanism && m.method == method) return &m;
  return nullptr;
}

const Measurement* best_simulation(const TablesResult& result, const std::string& mechanism) {
  const Measurement* best = nullptr;
  for (const Measurement& m : result.simulations)
    if (m.mechanism == mechanism && m.stopped.empty() && (!best || m.milliseconds < best->milliseconds))
      best = &m;
  return best;
}

double evaluation(const TablesResult& result, const std::string& mechanism, const std::string& formulation) {
  for (const EvaluationTime& e : result.evaluations)
    if (e.mechanism == mechanism && e.formulation == formulation) return e.microseconds;
  return 0;
}

}  // namespace sinew::study
