#include <algorithm>
#include <cmath>
#include <memory>

#include "sinew/animation/sampling_job.h"
#include "study/accuracy.h"
#include "study/bodies.h"
#include "study/humanoid.h"
#include "study/mannequin.h"

namespace sinew::study {
namespace {

AccuracyScene tumbling_body() {
  AccuracyScene s;
  s.name = "tumbling";
  s.title = "A tumbling box in the air";
  s.reading =
      "No contact, no joint: only the rotation is integrated. Lines fall with their order: twice the time "
      "buys half "
      "the error of a first-order scheme and a quarter of a second-order one.";
  s.scene.ground = false;
  s.scene.gravity.setZero();
  Figure body = resting(free_body(1, box_inertia(1, {0.1, 0.2, 0.3})));
  body.jets[0].omega = {0.5, 6, 0.8};
  s.scene.figures.push_back(body);
  return s;
}

AccuracyScene ragdoll_drop() {
  AccuracyScene s;
  s.name = "drop";
  s.title = "A limp figure drops to the floor";
  s.reading =
      "37 degrees of freedom, compared until 0.3 s after the feet touch: later, chaos would be compared, not "
      "solvers. "
      "What an impact takes depends on the step as long as contacts have no damping of their own: lines "
      "level out.";
  s.seconds = 0.5;
  s.contacts = true;
  Figure figure = resting(humanoid());
  make_frictionless(figure.skeleton);
  figure.jets[0].translation.z() += 0.15;
  randomise_speeds(figure.skeleton, figure.jets, 1, 4);
  s.scene.figures.push_back(figure);
  return s;
}

AccuracyScene collapse() {
  AccuracyScene s;
  s.name = "collapse";
  s.title = "A standing figure goes limp";
  s.reading =
      "37 degrees of freedom with both feet on the floor from the start: contact and friction, but no impact "
      "yet.";
  s.seconds = 0.4;
  s.contacts = true;
  Figure figure = resting(humanoid());
  make_frictionless(figure.skeleton);
  // The chest nods at 1 rad/s about its lower end, 0.36 m below its joint, so that the column does not stay
  // upright.
  figure.jets[0].omega = {0, 1, 0};
  figure.jets[0].velocity = {0.36, 0, 0};
  figure.jets[1].omega = {0, -1, 0};
  s.scene.figures.push_back(figure);
  return s;
}

AccuracyScene stack() {
  AccuracyScene s;
  s.name = "stack";
  s.title = "50 kg on 1 kg";
  s.reading =
      "A light cube lies under a box 50 times as heavy. Error: how far from their place of rest both are "
      "after 1 s.";
  s.contacts = s.settles = true;
  Figure light = resting(box_body(1, {0.2, 0.2, 0.2})), heavy = resting(box_body(50, {0.3, 0.3, 0.3}));
  light.jets[0].translation.z() = 0.1;
  heavy.jets[0].translation.z() = 0.35;
  s.scene.figures = {light, heavy};
  return s;
}

AccuracyScene tracking() {
  AccuracyScene s;
  s.name = "tracking";
  s.title = "Muscles follow a walk and are pushed";
  s.reading =
      "The mannequin walks on its clip; forearm and chest are pushed for 0.1 s, harder than muscles hold. "
      "Ours hands joints over to "
      "the "
      "solver only where a muscle is too weak; MuJoCo tracks with servos of the same strength.";
  const Asset* asset = mannequin();
  const int clip = asset ? asset->find_clip("walk") : -1;
  if (clip < 0) return s;
  const auto sample = [asset, clip](double time) {
    std::vector<JointJet<double>> jets(asset->skeleton.joints.size());
    SamplingJob<double>{&asset->clips[clip], time, 1, jets}.Run();
    return jets;
  };
  s.scene.figures.push_back({asset->skeleton, sample(0), true});
  make_frictionless(s.scene.figures[0].skeleton);
  const int arm = asset->skeleton.find(Role::kForearmR), chest = asset->skeleton.find(Role::kChest);
  s.drive = [sample, arm, chest](Engine& engine, double t, double h) {
    engine.aim(0, sample(t + h));
    const double pushed = std::max(0.0, std::min(t + h, 0.4) - std::max(t, 0.3));  // s of this step
    if (pushed <= 0) return;
    engine.push(0, arm, Vec3<double>(250, 60, 0) * pushed);
    engine.push(0, chest, Vec3<double>(-600, 0, 0) * pushed);
  };
  return s;
}

}  // namespace

std::vector<AccuracyScene> accuracy_scenes() {
  return {tumbling_body(), collapse(), ragdoll_drop(), stack(), tracking()};
}

}  // namespace sinew::study
