// Simbody 3.7: its own equations of motion and integrators.
#include <dlfcn.h>

#include <Eigen/QR>

#include "study/tables/peers/families.h"
#include "study/tables/peers/simbody_run.h"

namespace sinew::study {
namespace {

using Simulate = decltype(&sinew_simulate_with_simbody);

/// The module's entry, or why it cannot be loaded.
struct Module {
  Simulate simulate = nullptr;
  std::string fault;

  Module() {
    if (void* module = dlopen(SINEW_SIMBODY_MODULE, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND))
      simulate = reinterpret_cast<Simulate>(dlsym(module, "sinew_simulate_with_simbody"));
    if (!simulate) fault = std::string("Simbody cannot be loaded: ") + dlerror();
  }
};

/// [loop] whether its five conditions are dependent at the start.
std::vector<bool> redundant_loops(const multibody::Model& model) {
  multibody::BodyMotion motion(model);
  multibody::Matrix jacobian(model.loop_rows, model.size());
  move_to(model, multibody::Vector::Zero(model.size()), motion);
  closure_jacobian(model, motion, jacobian);
  std::vector<bool> redundant;
  for (const multibody::LoopModel& l : model.loops) {
    const int rows = multibody::equation_count(l.type);
    redundant.push_back(jacobian.middleRows(l.first_row, rows).colPivHouseholderQr().rank() < rows);
  }
  return redundant;
}

Peer peer(const std::string& name, bool cpodes) {
  const auto simulate = [cpodes](const StudyCase& c, double tolerance, Trajectory& out, SimulationRun& m,
                                 double& seconds) {
    static const Module module;
    if (!module.simulate) return module.fault;
    SimbodyRun run;
    run.cpodes = cpodes;
    run.accuracy = tolerance;
    // A step longer than a bump of the road could pass it unseen; the same limit as ours.
    const multibody::Model model(c.mechanism);
    run.max_step = model.shortest_profile;
    run.one_angle = redundant_loops(model);
    run.instants = c.reference.t;
    module.simulate(c.mechanism, run);
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      out.t.push_back(run.instants[i]);
      out.y.push_back(Eigen::Map<const multibody::Vector>(run.rows[i].data(), run.rows[i].size()));
    }
    m.steps = run.steps;
    m.evaluations = run.evaluations;
    seconds = run.seconds;
    return run.stopped;
  };
  return {name, cpodes, [name, simulate](const StudyCase& c, double tolerance, int repeats) {
            return measure_peer(name, c, tolerance, repeats,
                                [&](Trajectory& out, SimulationRun& m, double& seconds) {
                                  return simulate(c, tolerance, out, m, seconds);
                                });
          }};
}

}  // namespace

std::vector<Peer> simbody_peers() {
  return {peer("Simbody · Runge–Kutta–Merson", false), peer("Simbody · CPodes", true)};
}

}  // namespace sinew::study
