// The catalogue's conditions on every step: what solving it may cost, and how exactly it is solved.
#include <algorithm>
#include <cmath>
#include <vector>

#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

/// Passes of all solves of a step: what it cost, counted.
template <class T>
int work_of_step(Stage<T>& stage) {
  int passes = 0;
  for (int c = 0; c < stage.world().character_count(); ++c) {
    const CharacterReport& report = stage.character(c).report();
    if (report.unknown_dofs > 0) passes += report.outer_passes;
  }
  return passes;
}

/// Limp figures fall and lie, as in limp_fall: the dearest of its steps against the usual one.
template <class T>
Verdict effort_of_a_step(const Trial& t) {
  Measurement measured;
  std::vector<int> work;
  for (unsigned seed = 1; seed <= (t.quick ? 6u : 40u); ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene);
    stage.run(3, t.h, [&](double time) {
      if (time > 0) work.push_back(work_of_step(stage));
    });
    measured.merge(stage.measured());
  }
  std::sort(work.begin(), work.end());
  const double median = std::max(1, work[work.size() / 2]);
  Verdict v(measured);
  v.sound();
  v.at_most("99th percentile of passes", v.measured().passes_percentile(0.99), 8);
  v.at_most("passes of the dearest step over the median's", work.back() / median, 10);
  v.at_most("passes of a solve", v.measured().most_passes, 16);
  return v;
}

/// Whether a step's report says that it was not simply solved.
bool took_a_rung(const CharacterReport& r) {
  return !r.converged || r.splits > 0 || r.restarts > 0 || r.damped > 0 || r.frozen > 0;
}

/// Every step is solved again from the same state, as exactly as numbers allow; how far off any joint was, of
/// the furthest that any goes in the step and what gravity would move in it.
template <class T>
Verdict residual_of_a_step(const Trial& t) {
  scene::Scene scene = t.scene;
  scene.characters[0].speeds.random = 3;
  scene::Scene exact_scene = scene;
  exact_scene.world.accuracy.tolerance = sizeof(T) == 4 ? 1e-7 : 1e-12;
  Stage<T> stage(scene), exact(exact_scene);
  std::vector<std::byte> saved(stage.world().snapshot_capacity());
  double worst = 0;
  int compared = 0;
  bool taken = true;
  stage.run(3, t.h, [&](double) {
    const std::size_t size = stage.world().save(saved);
    taken =
        taken && exact.world().restore(std::span(saved).first(size)).ok() && exact.world().step(T(t.h)).ok();
    const auto model = exact.character(0).model();
    const std::vector<Transform<T>> there(model.begin(), model.end());
    std::vector<Transform<T>> from(stage.character(0).model().begin(), stage.character(0).model().end());
    // The stage takes the same step after this: look at it in the next call, through what is kept here.
    const auto step = stage.world().step(T(t.h));
    const CharacterReport report = stage.character(0).report();
    double off = 0, way = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      const Transform<T>& now = stage.character(0).model()[i];
      off = std::max(off, double((now.translation - there[i].translation).norm()));
      way = std::max(way, double((now.translation - from[i].translation).norm()));
    }
    if (step.ok() && !took_a_rung(report) && report.unknown_dofs > 0)
      worst = std::max(worst, off / (way + 9.81 * t.h * t.h)), ++compared;
    taken = taken && stage.world().restore(std::span(saved).first(size)).ok();
  });
  Verdict v(stage.measured());
  v.sound();
  v.require(taken, "a state is not taken over");
  v.at_least("steps compared", compared, 100);
  v.at_most("off the exact solution, share of the step's way", worst, sizeof(T) == 4 ? 1e-4 : 1e-8);
  return v;
}

}  // namespace

std::vector<HardCase> general_cases() {
  return {
      {"effort_of_a_step",
       "G",
       "research 2, conditions on every case",
       "p99 of passes 8; the dearest step 10 times the median; no solve above 16 passes",
       {1.0 / 60},
       effort_of_a_step<float>,
       effort_of_a_step<double>,
       "",
       "limp_fall"},
      {"residual_of_a_step_in_flight",
       "G",
       "research 2, conditions on every case",
       "off the exact solution by 1e-4 of the way in float, 1e-8 in double, or reported",
       {1.0 / 60},
       residual_of_a_step<float>,
       residual_of_a_step<double>,
       "",
       "free_flight"},
      {"residual_of_a_step_on_the_floor",
       "G",
       "research 2, conditions on every case",
       "off the exact solution by 1e-4 of the way in float, 1e-8 in double, or reported",
       {1.0 / 60},
       residual_of_a_step<float>,
       residual_of_a_step<double>,
       "",
       "limp_fall"},
  };
}

}  // namespace sinew::study
