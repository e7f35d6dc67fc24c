#include "study/tables/peers/simbody_run.h"

#include <time.h>

#include "study/tables/peers/simbody_model.h"

namespace sinew::study {
namespace {

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void integrate(const SimbodyModel& model, SimTK::Integrator& integrator, SimbodyRun& run) {
  integrator.setAccuracy(run.accuracy);
  if (run.max_step > 0) integrator.setMaximumStepSize(run.max_step);
  double begin = thread_seconds();
  integrator.initialize(model.start());
  run.seconds += thread_seconds() - begin;
  for (const double t : run.instants) {
    begin = thread_seconds();
    while (integrator.getState().getTime() < t) integrator.stepTo(t);  // interpolates: steps are not cut
    run.seconds += thread_seconds() - begin;
    std::vector<double>& row = run.rows.emplace_back();
    for (const SimTK::MobilizedBody& body : model.bodies)
      row.push_back(body.getOneQ(integrator.getState(), 0));
    for (const SimTK::MobilizedBody& body : model.bodies)
      row.push_back(body.getOneU(integrator.getState(), 0));
  }
  run.steps = integrator.getNumStepsTaken();
  run.evaluations = integrator.getNumRealizations();
}

}  // namespace

}  // namespace sinew::study

void sinew_simulate_with_simbody(const sinew::multibody::Mechanism& mechanism,
                                 sinew::study::SimbodyRun& run) {
  try {
    const sinew::study::SimbodyModel model(mechanism, run.one_angle);
    if (run.cpodes) {
      SimTK::CPodesIntegrator integrator(model.system);
      sinew::study::integrate(model, integrator, run);
    } else {
      SimTK::RungeKuttaMersonIntegrator integrator(model.system);
      sinew::study::integrate(model, integrator, run);
    }
  } catch (const std::exception& e) {
    run.stopped = std::string("Simbody: ") + e.what();
  }
}
