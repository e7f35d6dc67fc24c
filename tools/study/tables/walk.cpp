#include "study/tables/walk.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "study/tables/global/cartesian_equations.h"
#include "study/tables/radau5.h"

namespace sinew::study {
namespace {

using multibody::Equations;
using multibody::Integrator;
using multibody::Model;
using multibody::Vector;

constexpr long kMaxSteps = 20000;  ///< a row that needs more is no rival, and counting it would take an hour
const std::string kPenalty = "Cartesian-penalty", kMultipliers = "Cartesian-multipliers", kRadau = "RADAU5";

bool among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

multibody::SimulationSettings settings_of_row(const std::string& formulation, const std::string& integrator,
                                              double tolerance) {
  mechanism::SimulateOptions options;
  options.formulation = formulation;
  options.integrator = integrator;
  options.rtol = options.atol = tolerance;
  return mechanism::settings_of(options);
}

/// What differs between the rows: states of the integrator as states of the mechanism.
struct Sampled {
  Vector joints;  ///< q, q'
  double energy = 0, gap = 0;
};
using Sampler = std::function<Sampled(double t, const Vector& state)>;

double energy_of(const Model& model, double t, const Vector& joints, const multibody::BodyMotion& motion) {
  return kinetic_energy(model, motion) + potential_energy(model, t, joints.head(model.size()), motion);
}

/// Steps to the end, sampling outside the measured time.
void steps_to_the_end(Integrator& integrator, const Model& model, const std::vector<double>& instants,
                      const Sampler& sampler, SimulationRun& run, Trajectory& out) {
  double seconds = 0, first_energy = 0;
  std::size_t next = 0;
  const auto sample = [&] {
    for (; next < instants.size() && instants[next] <= integrator.time(); ++next) {
      const double t = instants[next];
      const Sampled s = sampler(t, integrator.at(t));
      if (next == 0) first_energy = s.energy;
      run.closure = std::max(run.closure, s.gap);
      run.energy_drift = std::max(run.energy_drift, std::abs(s.energy - first_energy));
      out.t.push_back(t);
      out.y.push_back(s.joints);
    }
  };
  sample();
  while (integrator.time() < model.mechanism().t_end && run.stopped.empty()) {
    const double begin = cpu_seconds();
    run.stopped = integrator.counts().steps < kMaxSteps
                      ? integrator.step()
                      : multibody::stopped(integrator.time(), "the most steps allowed are done");
    seconds += cpu_seconds() - begin;
    sample();
  }
  run.milliseconds = 1e3 * seconds;
  run.steps = integrator.counts().steps;
}

multibody::IntegratorSettings limits(const Model& model, double tolerance) {
  // A step longer than a bump of the road could pass it unseen.
  return {.rtol = tolerance, .atol = tolerance, .max_step = model.shortest_profile};
}

void walk_radau(const Model& model, const std::string& formulation, double tolerance,
                const std::vector<double>& instants, SimulationRun& run, Trajectory& out) {
  const auto chosen =
      settings_of_row(formulation, "DASSL", tolerance);  // for what the formulation's name says
  Equations equations(model, chosen.formulation, chosen.tangent, chosen.closure);
  Vector start;
  run.stopped = equations.start(start);
  if (!run.stopped.empty()) return;
  Radau5 integrator(equations, complex_half(equations), 0, start, model.mechanism().t_end,
                    limits(model, tolerance));
  const auto sampler = [&](double t, Vector joints) {
    equations.close(joints);
    Vector gap(model.loop_rows);
    closure(model, equations.motion(), gap);
    return Sampled{joints, energy_of(model, t, joints, equations.motion()),
                   gap.size() == 0 ? 0 : gap.cwiseAbs().maxCoeff()};
  };
  steps_to_the_end(integrator, model, instants, sampler, run, out);
  run.evaluations = equations.counts().derivatives + equations.counts().residuals;
  run.tangents = equations.counts().tangents;
  run.factorisations = equations.counts().factorisations;
}

GlobalClosure closure_of_row(const std::string& formulation) {
  return formulation == kPenalty ? GlobalClosure::kPenalty : GlobalClosure::kMultipliers;
}

void walk_global(const Model& model, const std::string& formulation, const std::string& integrator_name,
                 double tolerance, const std::vector<double>& instants, SimulationRun& run, Trajectory& out) {
  CartesianEquations equations(model, closure_of_row(formulation));
  Vector start;
  run.stopped = equations.start(start);
  if (!run.stopped.empty()) return;
  const auto integrator =
      multibody::start(settings_of_row("RR-JF", integrator_name, tolerance).method, equations, 0, start,
                       model.mechanism().t_end, limits(model, tolerance));
  const auto sampler = [&](double t, const Vector& state) {
    const Vector joints = equations.joints_of(state);
    return Sampled{joints, energy_of(model, t, joints, equations.motion()), equations.gap()};
  };
  steps_to_the_end(*integrator, model, instants, sampler, run, out);
  run.evaluations = equations.counts().evaluations;
  run.tangents = equations.counts().tangents;
  run.factorisations = equations.counts().factorisations;
}

}  // namespace

EvaluationWork global_evaluations(const StudyCase& c, const std::string& formulation) {
  struct Shared {
    Model model;
    CartesianEquations equations;
    std::vector<Vector> states;
    Vector out;
    Shared(const StudyCase& of, GlobalClosure closure) : model(of.mechanism), equations(model, closure) {}
  };
  const auto work = std::make_shared<Shared>(c, closure_of_row(formulation));
  Vector start;
  if (!work->equations.start(start).empty()) return {};
  const int count = evaluations_per_run(c.name);
  const bool whole = count > 1 && !c.reference.y.empty() && c.reference.y[0].allFinite();
  std::mt19937 random(1);
  std::normal_distribution<double> off(0, 1e-6);
  for (int i = 0; i < count; ++i) {
    Vector state = start;
    if (whole) state = work->equations.state_of(c.reference.y[i * (c.reference.y.size() - 1) / (count - 1)]);
    for (double& x : state) x += off(random);
    work->states.push_back(state);
  }
  const auto run = [work] {
    for (const Vector& state : work->states) (void)work->equations.derivative(0, state, work->out);
  };
  return {run, count};
}

bool only_in_the_study(const std::string& formulation, const std::string& integrator) {
  return formulation.starts_with("Cartesian") || integrator == kRadau;
}

std::string fault_of_row(const Model& model, const std::string& formulation, const std::string& integrator) {
  const bool global = formulation == kPenalty || formulation == kMultipliers;
  if (!global && !among(mechanism::formulation_names(), formulation))
    return "unknown formulation '" + formulation + "': there are those of sinew simulate, " + kPenalty +
           " and " + kMultipliers;
  if (integrator != kRadau && !among(mechanism::integrator_names(), integrator))
    return "unknown integrator '" + integrator + "': there are those of sinew simulate and " + kRadau;
  if (!global && integrator == kRadau) return {};
  if (!global) return mismatch(model, settings_of_row(formulation, integrator, 1e-5));
  if (integrator == kRadau)
    return kRadau + " needs the complex half of a system, which " + formulation + " has not";
  if (integrator == "ode15sR") return formulation + " gives derivatives: use ode15s";
  return {};
}

void walk(const Model& model, const std::string& formulation, const std::string& integrator, double tolerance,
          const std::vector<double>& instants, SimulationRun& run, Trajectory& out) {
  run.stopped = fault_of_row(model, formulation, integrator);
  if (!run.stopped.empty()) return;
  if (integrator == kRadau)
    walk_radau(model, formulation, tolerance, instants, run, out);
  else
    walk_global(model, formulation, integrator, tolerance, instants, run, out);
}

}  // namespace sinew::study
