// Simbody 3.7: its own equations of motion and integrators.
#include "study/tables/peers/families.h"
#include "study/tables/peers/simbody_run.h"

namespace sinew::study {
namespace {

Peer peer(const std::string& name, bool cpodes) {
  const auto simulate = [cpodes](const StudyCase& c, double tolerance, Trajectory& out, Measurement& m,
                                 double& seconds) {
    SimbodyRun run;
    run.cpodes = cpodes;
    run.accuracy = tolerance;
    // A step longer than a bump of the road could pass it unseen; the same limit as ours.
    run.max_step = multibody::Model(c.mechanism).shortest_profile;
    run.instants = c.reference.t;
    simulate_with_simbody(c.mechanism, run);
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
            return measure_peer(name, c, tolerance, repeats, [&](Trajectory& out, Measurement& m, double& seconds) {
              return simulate(c, tolerance, out, m, seconds);
            });
          }};
}

}  // namespace

std::vector<Peer> simbody_peers() {
  return {peer("Simbody · Runge–Kutta–Merson", false), peer("Simbody · CPodes", true)};
}

}  // namespace sinew::study
