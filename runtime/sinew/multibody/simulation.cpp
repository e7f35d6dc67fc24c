#include "sinew/multibody/simulation.h"

#include <cmath>
#include <ctime>

namespace sinew::multibody {
namespace {

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Sample sample_at(Equations& equations, double t, Vector y, double work) {
  const Model& model = equations.model();
  const Eigen::Index n = model.size();
  Sample s;
  s.t = t;
  equations.close(y);
  const BodyMotion& motion = equations.motion();
  s.kinetic = kinetic_energy(model, motion);
  s.potential = potential_energy(model, t, y.head(n), motion);
  Vector phi(model.loop_rows);
  closure(model, motion, phi);
  s.closure = phi.size() == 0 ? 0 : phi.cwiseAbs().maxCoeff();
  for (const BodyPoint& p : model.points) s.points.push_back(position_of(motion, p));
  s.y = std::move(y);
  s.work = work;
  return s;
}

/// Work of the non-conservative forces from `from` to `to` inside the last step, by Gauss–Legendre quadrature
/// of order 6.
double work_over(Equations& equations, const Integrator& integrator, double from, double to) {
  if (!(to > from)) return 0;
  const double node = std::sqrt(0.6), middle = 0.5 * (from + to), half = 0.5 * (to - from);
  const Model& model = equations.model();
  const Eigen::Index n = model.size();
  const auto power = [&](double t) {
    Vector y = integrator.at(t);
    equations.close(y);
    return power_of_others(model, t, y.head(n), y.tail(n), equations.motion());
  };
  return half * (5 * power(middle - node * half) + 8 * power(middle) + 5 * power(middle + node * half)) / 9;
}

}  // namespace

std::string mismatch(const Model& model, const SimulationSettings& s) {
  const bool closed = model.loop_rows > 0, residuals = s.formulation == Formulation::kRr;
  if (s.formulation == Formulation::kDtr && closed)
    return "DTR is for open chains and this mechanism has loops: use DSR-Rz or RR-Rz";
  if (residuals && (s.method == Method::kDe || s.method == Method::kOde15s))
    return s.method == Method::kDe ? "DE integrates derivatives and RR gives residuals: use DTR or DSR"
                                   : "ode15s integrates derivatives and RR gives residuals: use ode15sR";
  if (!residuals && s.method == Method::kOde15sR)
    return "ode15sR integrates residuals: use RR, or ode15s for derivatives";
  if (s.formulation == Formulation::kDtr && s.tangent == Tangent::kAnalytic && s.method != Method::kDe)
    return "DTR has no analytic tangent (it forms no mass matrix): use DTR-JN, DSR-JF or RR-JF";
  return {};
}

std::vector<double> instants(double t_end, int intervals) {
  std::vector<double> t;
  for (int i = 0; i <= intervals; ++i) t.push_back(t_end * i / intervals);
  return t;
}

SimulationResult simulate(const Model& model, const SimulationSettings& settings,
                          const std::function<void(double)>& progress) {
  SimulationResult result;
  Equations equations(model, settings.formulation, settings.tangent, settings.closure);
  Vector y0;
  result.stopped = equations.start(y0);
  if (!result.stopped.empty()) return result;
  const double t_end = settings.t_end > 0 ? settings.t_end : model.mechanism().t_end;
  IntegratorSettings chosen = settings.integrator;
  // A step longer than a bump of the road could pass it unseen: the error estimate samples only the step's
  // end.
  if (model.shortest_profile > 0 && (chosen.max_step <= 0 || chosen.max_step > model.shortest_profile))
    chosen.max_step = model.shortest_profile;

  double measured = 0, work = 0, worked_until = 0;
  double begin = cpu_seconds();
  auto integrator = start(settings.method, equations, 0, y0, t_end, chosen);
  std::size_t next = 0;
  const auto work_until = [&](double t) {
    if (settings.energy) work += work_over(equations, *integrator, worked_until, t);
    worked_until = t;
  };
  const auto emit = [&](double t) {
    work_until(t);
    result.samples.push_back(sample_at(equations, t, integrator->at(t), work));
  };
  // Sampling and the energy balance are not the integration's time.
  const auto look = [&] {
    measured += cpu_seconds() - begin;
    for (; next < settings.output.size() && settings.output[next] <= integrator->time(); ++next)
      emit(settings.output[next]);
    work_until(integrator->time());
    begin = cpu_seconds();
  };
  look();
  while (integrator->time() < t_end) {
    result.stopped =
        integrator->counts().steps < settings.max_steps
            ? integrator->step()
            : stopped(integrator->time(), "the most steps allowed are done and the end is not near");
    if (!result.stopped.empty()) break;
    if (progress) progress(integrator->time());
    if (settings.energy || (next < settings.output.size() && settings.output[next] <= integrator->time()))
      look();
  }
  result.seconds = measured + cpu_seconds() - begin;
  if (!result.stopped.empty() && (result.samples.empty() || result.samples.back().t < integrator->time()))
    emit(integrator->time());
  result.steps = integrator->counts();
  result.evaluations = equations.counts();
  result.looks_stiff = integrator->looks_stiff();
  return result;
}

}  // namespace sinew::multibody
