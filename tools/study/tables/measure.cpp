#include "study/tables/measure.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <sstream>

#include "study/tables/chains.h"
#include "study/tables/walk.h"

namespace sinew::study {
namespace {

using multibody::Equations;
using multibody::Formulation;
using multibody::Model;
using multibody::Tangent;
using multibody::Vector;

constexpr int kStates = 16;  ///< of a mechanism at which evaluations are measured
const std::string kChainPrefix = "chain:";

/// "DTR", "DSR…" and "RR…": what they evaluate.
Formulation kind_of(const std::string& formulation) {
  return formulation.starts_with("DTR")   ? Formulation::kDtr
         : formulation.starts_with("DSR") ? Formulation::kDsr
                                          : Formulation::kRr;
}

/// Index 2 where the name says so.
multibody::Closure closure_of(const std::string& formulation) {
  return formulation.find("-Rz2") == std::string::npos ? multibody::Closure::kInEvaluations
                                                       : multibody::Closure::kInSteps;
}

/// The study's stiff mechanisms, by their names in the paper's set.
bool known_stiff(const std::string& name) {
  return name == "suspension_mfs" || name.find("driver_stiff") == 0;
}

bool read_reference(const std::string& path, const multibody::Mechanism& mechanism, Trajectory& out) {
  std::ifstream file(path);
  if (!file) return false;
  std::string line, cell;
  std::getline(file, line);
  std::vector<int> place;  // of each column in y, or −1
  const int n = static_cast<int>(mechanism.joints.size());
  for (std::stringstream cells(line); std::getline(cells, cell, ',');) {
    int at = -1;
    for (int i = 0; i < n; ++i) {
      if (cell == "q:" + mechanism.joints[i].name) at = i;
      if (cell == "u:" + mechanism.joints[i].name) at = n + i;
    }
    place.push_back(at);
  }
  if (std::none_of(place.begin(), place.end(), [](int p) { return p >= 0; })) return false;
  while (std::getline(file, line)) {
    Vector y = Vector::Constant(2 * n, std::numeric_limits<double>::quiet_NaN());
    std::size_t column = 0;
    for (std::stringstream cells(line); std::getline(cells, cell, ','); ++column) {
      if (column == 0) out.t.push_back(std::stod(cell));
      if (place[column] >= 0) y[place[column]] = std::stod(cell);
    }
    out.y.push_back(y);
  }
  return !out.t.empty();
}

Trajectory trajectory_of(const multibody::SimulationResult& run) {
  Trajectory out;
  for (const multibody::Sample& s : run.samples) {
    out.t.push_back(s.t);
    out.y.push_back(s.y);
  }
  return out;
}

/// Once, by the runtime's own simulation.
void simulate_once(const Model& model, const std::string& formulation, const std::string& integrator,
                   double tolerance, const std::vector<double>& instants, SimulationRun& m, Trajectory& out) {
  mechanism::SimulateOptions options;
  options.formulation = formulation;
  options.integrator = integrator;
  options.rtol = options.atol = tolerance;
  options.instants = instants;
  const multibody::SimulationResult run = simulate(model, settings_of(options));
  out = trajectory_of(run);
  m.milliseconds = 1e3 * run.seconds;
  m.stopped = run.stopped;
  m.steps = run.steps.steps;
  m.evaluations = run.evaluations.derivatives + run.evaluations.residuals;
  m.tangents = run.evaluations.tangents;
  m.factorisations = run.evaluations.factorisations;
  for (const multibody::Sample& s : run.samples) {
    const multibody::Sample& first = run.samples.front();
    m.closure = std::max(m.closure, s.closure);
    m.energy_drift =
        std::max(m.energy_drift, std::abs(s.kinetic + s.potential - first.kinetic - first.potential));
  }
}

}  // namespace

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TrueError error_of(const Trajectory& trajectory, const Trajectory& reference) {
  TrueError worst;
  const std::size_t samples = std::min(trajectory.y.size(), reference.y.size());
  for (std::size_t s = 0; s < samples; ++s) {
    const Vector &y = trajectory.y[s], &is = reference.y[s];
    const Eigen::Index n = y.size() / 2;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (std::isnan(is[i])) continue;  // the table does not say
      const double error = std::abs(y[i] - is[i]) / (1 + std::abs(is[i]));
      double& where = i < n ? worst.q : worst.u;
      where = std::isfinite(error) ? std::max(where, error) : std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

std::string load_mechanism_only(const std::string& directory, const std::string& name, StudyCase& out) {
  out = {};
  out.name = name;
  out.stiff = known_stiff(name);
  if (name.starts_with(kChainPrefix)) {
    out.mechanism = chain_of(std::atoi(name.c_str() + kChainPrefix.size()));
    return {};
  }
  const std::string why = mechanism::load_mechanism(directory + "/" + name + ".json", out.mechanism);
  if (why.empty())
    (void)read_reference(directory + "/reference/" + name + ".csv", out.mechanism, out.reference);
  return why;
}

std::string load_case(const std::string& directory, const std::string& name, StudyCase& out) {
  if (std::string why = load_mechanism_only(directory, name, out); !why.empty()) return why;
  if (!out.reference.t.empty()) return {};
  multibody::SimulationSettings settings;
  settings.formulation = Formulation::kDsr;
  settings.method = multibody::Method::kDe;
  settings.integrator.rtol = settings.integrator.atol = 1e-12;
  settings.output = multibody::instants(out.mechanism.t_end, 50);
  const multibody::SimulationResult run = simulate(Model(out.mechanism), settings);
  out.reference = trajectory_of(run);
  return run.stopped.empty() ? "" : directory + "/" + name + ".json: " + run.stopped;
}

std::function<void()> simulation_of(const StudyCase& c, const std::string& formulation,
                                    const std::string& integrator, double tolerance) {
  if (only_in_the_study(formulation, integrator))
    return [model = Model(c.mechanism), formulation, integrator, tolerance] {
      SimulationRun run;
      Trajectory none;
      walk(model, formulation, integrator, tolerance, {}, run, none);
    };
  mechanism::SimulateOptions options;
  options.formulation = formulation;
  options.integrator = integrator;
  options.rtol = options.atol = tolerance;
  return [model = Model(c.mechanism), settings = settings_of(options)] { (void)simulate(model, settings); };
}

SimulationRun measure(const StudyCase& c, const std::string& formulation, const std::string& integrator,
                      double tolerance, int repeats) {
  const Model model(c.mechanism);
  SimulationRun m;
  m.mechanism = c.name;
  m.method = integrator + " · " + formulation;
  m.tolerance = tolerance;
  m.stopped = fault_of_row(model, formulation, integrator);
  double quickest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats && m.stopped.empty(); ++i) {
    Trajectory trajectory;
    if (only_in_the_study(formulation, integrator))
      walk(model, formulation, integrator, tolerance, c.reference.t, m, trajectory);
    else
      simulate_once(model, formulation, integrator, tolerance, c.reference.t, m, trajectory);
    quickest = std::min(quickest, m.milliseconds);
    m.error = error_of(trajectory, c.reference);
  }
  m.milliseconds = quickest;
  return m;
}

int evaluations_per_run(const std::string& mechanism) {
  return mechanism.starts_with(kChainPrefix) ? 1 : kStates;
}

EvaluationWork evaluations_of(const StudyCase& c, const std::string& formulation) {
  if (only_in_the_study(formulation, "")) return global_evaluations(c, formulation);
  struct Shared {
    Model model;
    Equations equations;
    std::vector<Vector> states, rates;
    Vector out;
    Shared(const StudyCase& of, Formulation kind, multibody::Closure closure)
        : model(of.mechanism), equations(model, kind, Tangent::kAnalytic, closure) {}
  };
  const Formulation kind = kind_of(formulation);
  const auto work = std::make_shared<Shared>(c, kind, closure_of(formulation));
  Equations derivatives(work->model, Formulation::kDsr, Tangent::kNumeric);
  Vector start;
  if (!work->equations.start(start).empty() || !derivatives.start(start).empty()) return {};
  std::mt19937 random(1);
  std::normal_distribution<double> off(0, 1e-6);
  const int states = evaluations_per_run(c.name);
  const bool whole = !c.reference.y.empty() && c.reference.y[0].allFinite();
  for (int i = 0; i < states; ++i) {
    Vector y = whole && states > 1 ? c.reference.y[i * (c.reference.y.size() - 1) / (states - 1)] : start;
    Vector yp = Vector::Ones(y.size());
    for (double& x : y) x += off(random);
    // A state that cannot be evaluated (exactly singular) is replaced by the start.
    if (kind == Formulation::kRr && states > 1 && !derivatives.derivative(0, y, yp)) y = start, yp.setZero();
    work->states.push_back(y);
    work->rates.push_back(yp);
  }
  work->out.resize(start.size());
  const auto run = [work, kind] {
    for (std::size_t s = 0; s < work->states.size(); ++s) {
      if (kind == Formulation::kRr)
        work->equations.residual(0, work->states[s], work->rates[s], work->out);
      else
        work->equations.derivative(0, work->states[s], work->out);
    }
  };
  return {run, states};
}

double evaluation_time(const StudyCase& c, const std::string& formulation, int repeats) {
  const EvaluationWork work = evaluations_of(c, formulation);
  if (!work.run) return 0;
  const int rounds = std::max(1, 2000 / static_cast<int>(c.mechanism.joints.size()));
  double best = std::numeric_limits<double>::infinity();
  for (int r = 0; r < repeats; ++r) {
    const double begin = cpu_seconds();
    for (int i = 0; i < rounds; ++i) work.run();
    best = std::min(best, (cpu_seconds() - begin) / (rounds * static_cast<double>(work.evaluations)));
  }
  return 1e6 * best;
}

}  // namespace sinew::study
