#include "study/tables/measure.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

namespace sinew::study {
namespace {

using multibody::Equations;
using multibody::Formulation;
using multibody::Model;
using multibody::Tangent;
using multibody::Vector;

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
  if (std::count_if(place.begin(), place.end(), [](int p) { return p >= 0; }) != 2 * n) return false;
  while (std::getline(file, line)) {
    Vector y(2 * n);
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
    const Vector relative = (y - is).cwiseAbs().cwiseQuotient((is.cwiseAbs().array() + 1).matrix());
    const Eigen::Index n = y.size() / 2;
    worst.q = std::max(worst.q, relative.head(n).maxCoeff());
    worst.u = std::max(worst.u, relative.tail(n).maxCoeff());
  }
  return worst;
}

std::string load_case(const std::string& directory, const std::string& name, StudyCase& out) {
  out = {};
  out.name = name;
  out.stiff = known_stiff(name);
  if (std::string why = mechanism::load_mechanism(directory + "/" + name + ".json", out.mechanism);
      !why.empty())
    return why;
  if (read_reference(directory + "/reference/" + name + ".csv", out.mechanism, out.reference)) return {};
  multibody::SimulationSettings settings;
  settings.formulation = Formulation::kDsr;
  settings.method = multibody::Method::kDe;
  settings.integrator.rtol = settings.integrator.atol = 1e-12;
  settings.output = multibody::instants(out.mechanism.t_end, 50);
  const multibody::SimulationResult run = simulate(Model(out.mechanism), settings);
  out.reference = trajectory_of(run);
  return run.stopped.empty() ? "" : directory + "/" + name + ".json: " + run.stopped;
}

Measurement measure(const StudyCase& c, const std::string& formulation, const std::string& integrator,
                    double tolerance, int repeats) {
  Measurement m;
  m.mechanism = c.name;
  m.method = integrator + " · " + formulation;
  m.tolerance = tolerance;
  m.milliseconds = std::numeric_limits<double>::infinity();
  const Model model(c.mechanism);
  mechanism::SimulateOptions options;
  options.formulation = formulation;
  options.integrator = integrator;
  options.rtol = options.atol = tolerance;
  options.instants = c.reference.t;
  const multibody::SimulationSettings settings = settings_of(options);
  for (int i = 0; i < repeats; ++i) {
    const multibody::SimulationResult run = simulate(model, settings);
    m.milliseconds = std::min(m.milliseconds, 1e3 * run.seconds);
    m.stopped = run.stopped;
    if (i > 0) continue;
    m.error = error_of(trajectory_of(run), c.reference);
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
    if (!run.stopped.empty()) break;
  }
  return m;
}

double evaluation_time(const StudyCase& c, Formulation formulation, int repeats) {
  const Model model(c.mechanism);
  Equations equations(model, formulation, Tangent::kAnalytic),
      derivatives(model, Formulation::kDsr, Tangent::kNumeric);
  Vector start;
  if (!equations.start(start).empty() || !derivatives.start(start).empty()) return 0;
  std::mt19937 random(1);
  std::normal_distribution<double> off(0, 1e-6);
  constexpr int kStates = 16;
  std::vector<Vector> states, rates;
  for (int i = 0; i < kStates; ++i) {
    Vector y = c.reference.y[i * (c.reference.y.size() - 1) / (kStates - 1)], yp(y.size());
    for (double& x : y) x += off(random);
    if (!derivatives.derivative(0, y, yp)) continue;
    states.push_back(y);
    rates.push_back(yp);
  }
  Vector out(start.size());
  const int rounds = std::max(1, 2000 / model.size());
  double best = std::numeric_limits<double>::infinity();
  for (int r = 0; r < repeats; ++r) {
    const double begin = cpu_seconds();
    for (int i = 0; i < rounds; ++i)
      for (std::size_t s = 0; s < states.size(); ++s) {
        if (formulation == Formulation::kRr)
          equations.residual(0, states[s], rates[s], out);
        else
          equations.derivative(0, states[s], out);
      }
    best = std::min(best, (cpu_seconds() - begin) / (rounds * static_cast<double>(states.size())));
  }
  return 1e6 * best;
}

}  // namespace sinew::study
