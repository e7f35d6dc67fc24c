#include "mechanism/simulate_mechanism.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew::mechanism {
namespace {

using multibody::Closure;
using multibody::Formulation;
using multibody::Method;
using multibody::Tangent;

struct FormulationChoice {
  Formulation formulation;
  Tangent tangent;
  Closure closure = Closure::kInEvaluations;
};

const std::map<std::string, FormulationChoice>& formulations() {
  static const std::map<std::string, FormulationChoice> all = {
      {"DTR", {Formulation::kDtr, Tangent::kNumeric}},
      {"DSR", {Formulation::kDsr, Tangent::kNumeric}},
      {"DSR-JF", {Formulation::kDsr, Tangent::kAnalytic}},
      {"DSR-Rz", {Formulation::kDsr, Tangent::kNumeric}},
      {"DSR-Rz-JF", {Formulation::kDsr, Tangent::kAnalytic}},
      {"RR-JN", {Formulation::kRr, Tangent::kNumeric}},
      {"RR-JF", {Formulation::kRr, Tangent::kAnalytic}},
      {"RR-Rz-JN", {Formulation::kRr, Tangent::kNumeric}},
      {"RR-Rz-JF", {Formulation::kRr, Tangent::kAnalytic}},
      {"DSR-Rz2", {Formulation::kDsr, Tangent::kNumeric, Closure::kInSteps}},
      {"DSR-Rz2-JF", {Formulation::kDsr, Tangent::kAnalytic, Closure::kInSteps}},
      {"RR-Rz2-JN", {Formulation::kRr, Tangent::kNumeric, Closure::kInSteps}},
      {"RR-Rz2-JF", {Formulation::kRr, Tangent::kAnalytic, Closure::kInSteps}},
  };
  return all;
}

const std::map<std::string, Method>& methods() {
  static const std::map<std::string, Method> all = {
      {"DE", Method::kDe},
      {"ode15s", Method::kOde15s},
      {"ode15sR", Method::kOde15sR},
      {"DASSL", Method::kDassl},
      {"DASSL-strict", Method::kDasslStrict},
      {"bdf1", Method::kBdf1},
      {"bdf2", Method::kBdf2},
  };
  return all;
}

template <class Map>
std::vector<std::string> keys(const Map& map) {
  std::vector<std::string> out;
  for (const auto& [name, value] : map) out.push_back(name);
  return out;
}

}  // namespace

const std::vector<std::string>& formulation_names() {
  static const std::vector<std::string> names = keys(formulations());
  return names;
}

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names = keys(methods());
  return names;
}

multibody::SimulationSettings settings_of(const SimulateOptions& o) {
  multibody::SimulationSettings s;
  s.formulation = formulations().at(o.formulation).formulation;
  s.tangent = formulations().at(o.formulation).tangent;
  s.closure = formulations().at(o.formulation).closure;
  s.method = methods().at(o.integrator);
  s.integrator = {.rtol = o.rtol, .atol = o.atol, .max_step = o.max_step, .fixed_step = o.fixed_step};
  s.t_end = o.t_end;
  s.max_steps = o.max_steps;
  s.output = o.instants;
  return s;
}

std::string simulate_mechanism(const multibody::Model& model, const SimulateOptions& options,
                               const std::function<void(double)>& progress,
                               multibody::SimulationResult& result) {
  multibody::SimulationSettings settings = settings_of(options);
  const double t_end = options.t_end > 0 ? options.t_end : model.mechanism().t_end;
  std::sort(settings.output.begin(), settings.output.end());
  if (settings.output.empty()) settings.output = multibody::instants(t_end, options.intervals);
  if (settings.output.front() < 0 || settings.output.back() > t_end)
    return "an instant of --at lies outside the simulated time";
  settings.energy = true;
  if (std::string why = multibody::mismatch(model, settings); !why.empty()) return why;
  result = multibody::simulate(model, settings, progress);
  return result.stopped;
}

nlohmann::json telemetry(const multibody::Model& model, const SimulateOptions& options,
                         const multibody::SimulationResult& r) {
  double closure = 0, imbalance = 0;
  for (const multibody::Sample& s : r.samples) {
    const multibody::Sample& first = r.samples.front();
    closure = std::max(closure, s.closure);
    imbalance =
        std::max(imbalance, std::abs(s.kinetic + s.potential - first.kinetic - first.potential - s.work));
  }
  nlohmann::json out = {
      {"mechanism", model.mechanism().name},
      {"coordinates", model.size()},
      {"loop_equations", model.loop_rows},
      {"formulation", options.formulation},
      {"integrator", options.integrator},
      {"rtol", options.rtol},
      {"atol", options.atol},
      {"time_reached_s", r.samples.empty() ? 0.0 : r.samples.back().t},
      {"steps", r.steps.steps},
      {"failed_steps", r.steps.error_failures + r.steps.newton_failures},
      {"newton_iterations", r.steps.newton_iterations},
      {"derivative_evaluations", r.evaluations.derivatives},
      {"residual_evaluations", r.evaluations.residuals},
      {"tangent_evaluations", r.evaluations.tangents},
      {"factorisations", r.evaluations.factorisations},
      {"cpu_seconds", r.seconds},
      {"closure_error_m", closure},
      {"energy_imbalance_J", imbalance},
      {"looks_stiff", r.looks_stiff},
      {"stopped", r.stopped},
  };
  if (!r.samples.empty()) {
    const multibody::Sample &first = r.samples.front(), &last = r.samples.back();
    out["energy_start_J"] = first.kinetic + first.potential;
    out["energy_end_J"] = last.kinetic + last.potential;
    out["work_J"] = last.work;
  }
  return out;
}

}  // namespace sinew::mechanism
