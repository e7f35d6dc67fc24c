// Boost.Odeint's adaptive Adams–Bashforth–Moulton (orders to 8) on derivatives.
#include <boost/numeric/odeint.hpp>

#include "study/tables/peers/families.h"

namespace sinew::study {
namespace {

using multibody::Equations;
using multibody::Vector;
using State = std::vector<double>;
namespace odeint = boost::numeric::odeint;

struct NoEvaluation {};

std::string adams(const StudyCase& c, double tolerance, Trajectory& out, SimulationRun& m, double& seconds) {
  using Stepper = odeint::adaptive_adams_bashforth_moulton<8, State>;
  using Controlled = odeint::controlled_adams_bashforth_moulton<Stepper>;
  const multibody::Model model(c.mechanism);
  Equations equations(model, derivatives_of(c), multibody::Tangent::kNumeric);
  Vector y0;
  if (std::string why = equations.start(y0); !why.empty()) return why;
  const Eigen::Index n = y0.size();
  Vector y(n), yp(n);
  const auto rate = [&](const State& state, State& result, double t) {
    ++m.evaluations;
    y = Eigen::Map<const Vector>(state.data(), n);
    if (!equations.derivative(t, y, yp)) throw NoEvaluation();
    Eigen::Map<Vector>(result.data(), n) = yp;
  };
  const double longest = model.shortest_profile > 0 ? model.shortest_profile : 1.0;
  Controlled stepper(Controlled::step_adjuster_type(tolerance, tolerance, longest));
  State state(y0.data(), y0.data() + n);
  double t = 0, h = 1e-6;
  try {
    m.evaluations = m.steps = 0;
    for (const double until : c.reference.t) {
      const double begin = cpu_seconds();
      // Walks over the instant freely; the sample is taken by one step of a copy, outside the measured time.
      Controlled before = stepper;
      State state_before = state;
      double t_before = t;
      while (t < until) {
        before = stepper;
        state_before = state;
        t_before = t;
        while (stepper.try_step(rate, state, t, h) == odeint::fail)
          if (h < 1e-14) return "Odeint: step too small at t = " + std::to_string(t);
        ++m.steps;
        if (equations.poorly_chosen()) {  // lets them choose other independent coordinates; the state stays
          y = Eigen::Map<const Vector>(state.data(), n);
          equations.accept(t, y);
        }
      }
      seconds += cpu_seconds() - begin;
      const long counted = m.evaluations;
      if (t > until) {
        double rest = until - t_before;
        while (t_before < until && before.try_step(rate, state_before, t_before, rest) == odeint::fail) {
        }
        for (rest = until - t_before; rest > 1e-12; rest = until - t_before)
          if (before.try_step(rate, state_before, t_before, rest) == odeint::fail && rest < 1e-14) break;
      } else {
        state_before = state;
      }
      m.evaluations = counted;
      Vector sample = Eigen::Map<Vector>(state_before.data(), n);
      equations.close(sample);
      out.t.push_back(until);
      out.y.push_back(sample);
    }
  } catch (const NoEvaluation&) {
    return "Odeint: the equations cannot be evaluated near t = " + std::to_string(t);
  }
  return {};
}

}  // namespace

std::vector<Peer> odeint_peers() {
  const std::string name = "Odeint · Adams (ABM 8)";
  return {{name, false, [name](const StudyCase& c, double tolerance, int repeats) {
             return measure_peer(name, c, tolerance, repeats,
                                 [&](Trajectory& out, SimulationRun& m, double& seconds) {
                                   return adams(c, tolerance, out, m, seconds);
                                 });
           }}};
}

}  // namespace sinew::study
