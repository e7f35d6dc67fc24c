#include <algorithm>
#include <cmath>
#include <memory>

#include "scene/humanoid.h"
#include "sinew/animation/sampling_job.h"
#include "study/accuracy.h"
#include "study/bodies.h"
#include "study/mannequin.h"

namespace sinew::study {
namespace {

constexpr double kQuarter = 1.5707963267948966;  // rad

AccuracyScene tumbling_body() {
  AccuracyScene s;
  s.name = "tumbling";
  s.title = "A tumbling box in the air";
  s.reading =
      "No contact, no joint: only the rotation is integrated. Lines fall with their order: twice the time "
      "buys half the error of a first-order scheme and a quarter of a second-order one. Our scheme moves a "
      "rigid body exactly, from its first step on.";
  s.to_catch_up = "a closed form for single bodies in flight; ours solves for them as for any tree.";
  s.scene.ground = false;
  s.scene.gravity.setZero();
  Figure body = resting(free_body(1, box_inertia(1, {0.1, 0.2, 0.3})));
  body.jets[0].omega = {0.5, 6, 0.8};
  s.scene.figures.push_back(body);
  return s;
}

/// Joints at so many rad/s (rms).
AccuracyScene flight(const char* name, double speed) {
  AccuracyScene s;
  s.name = name;
  s.title = "A limp figure flies, joints at " + std::to_string(std::lround(speed)) + " rad/s";
  s.reading =
      "37 degrees of freedom and nothing that bears on them: joints that turn fast are all that is "
      "integrated.";
  s.to_catch_up = "a method of higher order, whose stages a step with contacts would have no use for.";
  s.seconds = 0.5;
  s.scene.ground = false;
  Figure figure = resting(humanoid());
  make_frictionless(figure.skeleton);
  randomise_speeds(figure.skeleton, figure.jets, speed, 4);
  s.scene.figures.push_back(figure);
  return s;
}

AccuracyScene ragdoll_drop() {
  AccuracyScene s;
  s.name = "drop";
  s.title = "A limp figure drops to the floor";
  s.reading =
      "37 degrees of freedom, compared until 0.3 s after the feet touch: later, chaos would be compared, not "
      "solvers. A foot that hangs on nothing is stopped within a tenth of a millisecond and flies off: steps "
      "of a game do not see that, so lines level out. Falls are better judged as a crowd (below).";
  s.to_catch_up =
      "softer contacts, or friction within the impact itself. Ours let a figure sink by half a millimetre; "
      "who spreads an impact over 20 ms has something that steps resolve.";
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
  s.to_catch_up =
      "fewer evaluations where contacts stay as they are, and the normal force of this step instead of the "
      "last one in friction, whose lag is of first order.";
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
  s.to_catch_up =
      "a start at rest: ours begins without forces and sinks by 0.4 mm first, where an exact solver rests "
      "from the first step on.";
  s.contacts = s.settles = true;
  Figure light = resting(box_body(1, {0.2, 0.2, 0.2})), heavy = resting(box_body(50, {0.3, 0.3, 0.3}));
  light.jets[0].translation.z() = 0.1;
  heavy.jets[0].translation.z() = 0.35;
  s.scene.figures = {light, heavy};
  return s;
}

AccuracyScene pendulum(const char* name, int links, JointType joint, const Vec3<double>& lifted) {
  AccuracyScene s;
  s.name = name;
  s.title = "A pendulum of " + std::to_string(links) + " bars";
  s.reading =
      "No contact, no muscle, no damping: joints hold bars of a metre together that swing down from a "
      "quarter "
      "turn. Whoever integrates in joint coordinates has an easy time here; compared for a second, before "
      "chaos.";
  s.to_catch_up =
      "a scheme of fourth order where nothing touches the tree and nothing is stiff, as Runge and Kutta "
      "have.";
  s.scene.ground = false;
  ChainShape shape;
  shape.links = links;
  shape.joint = shape.root = joint;
  Figure figure = resting(chain(shape));
  bend(figure.skeleton, figure.jets, 0, lifted);
  s.scene.figures.push_back(figure);
  return s;
}

/// Newtons (world axes) on a body, from one time to another.
struct Shove {
  Role role;
  Vec3<double> force;
  double begin, end;  ///< s
};

AccuracyScene tracking(const char* name, const char* clip_name, const std::vector<Shove>& shoves) {
  AccuracyScene s;
  s.name = name;
  s.title = std::string("Muscles follow a ") + clip_name + " and are pushed";
  s.reading =
      "The mannequin moves on its clip; it is pushed for 0.1 s, harder than muscles hold. Joints are handed "
      "over to the solver only where a muscle is too weak.";
  s.beside_peers =
      "The others track with motors of the same strength, and solve for all joints in every step.";
  s.to_catch_up = "fewer joints handed over, or cheaper ones: the rest is played.";
  const Asset* asset = mannequin();
  const int clip = asset ? asset->find_clip(clip_name) : -1;
  if (clip < 0) return s;
  const auto sample = [asset, clip](double time) {
    std::vector<JointJet<double>> jets(asset->skeleton.joints.size());
    (void)SamplingJob<double>{&asset->clips[clip], time, jets}.Run();
    return jets;
  };
  s.scene.figures.push_back({asset->skeleton, sample(0), true});
  make_frictionless(s.scene.figures[0].skeleton);
  s.drive = [sample, asset, shoves](Engine& engine, double t, double h) {
    engine.aim(0, sample(t + h));
    for (const Shove& shove : shoves) {
      const double pushed = std::max(0.0, std::min(t + h, shove.end) - std::max(t, shove.begin));
      if (pushed > 0) engine.push(0, asset->skeleton.find(shove.role), shove.force * pushed);
    }
  };
  return s;
}

AccuracyScene levels_of_detail() {
  AccuracyScene s = tracking(
      "lod", "walk", {{Role::kForearmR, {250, 60, 0}, 0.3, 0.4}, {Role::kChest, {-600, 0, 0}, 0.3, 0.4}});
  s.title = "The same walk, further away";
  s.reading =
      "What is saved where nobody looks closely. Solved every second or fourth frame, the pose glides in "
      "between; "
      "residual only still tells the loads (of 8 or 16 characters at once for far less: same bits at any "
      "width), "
      "playback only nothing: all of these miss what the push does.";
  s.options = policy_options();
  return s;
}

/// The collapse another way.
AccuracyScene fainting() {
  AccuracyScene s = collapse();
  s.name = "faint";
  s.title = "A figure faints sideways";
  s.scene.figures[0].jets[0].omega = {0.7, 0.4, 0};
  s.scene.figures[0].jets[0].velocity = {0.144, -0.252, 0};
  s.scene.figures[0].jets[1].omega = {-0.7, -0.4, 0};
  return s;
}

}  // namespace

std::vector<AccuracyScene> accuracy_scenes() {
  return {tumbling_body(),
          pendulum("pendulum", 5, JointType::kRevolute, {0, kQuarter, 0}),
          flight("flight", 3),
          flight("wild_flight", 10),
          collapse(),
          ragdoll_drop(),
          stack(),
          tracking("tracking", "walk",
                   {{Role::kForearmR, {250, 60, 0}, 0.3, 0.4}, {Role::kChest, {-600, 0, 0}, 0.3, 0.4}}),
          tracking("running", "run",
                   {{Role::kForearmL, {-300, 150, 0}, 0.2, 0.3}, {Role::kChest, {-300, 900, 0}, 0.4, 0.5}}),
          levels_of_detail()};
}

std::vector<AccuracyScene> unseen_scenes() {
  AccuracyScene spun = tumbling_body();
  spun.name = "spun";
  spun.scene.figures[0].skeleton = free_body(2, box_inertia(2, {0.3, 0.12, 0.2}));
  spun.scene.figures[0].jets[0].omega = {4, 0.7, 3};
  return {spun, pendulum("rope", 3, JointType::kBall, {0.4, kQuarter, 0}), fainting(),
          tracking("jostled", "walk",
                   {{Role::kChest, {200, 700, 0}, 0.2, 0.3}, {Role::kForearmL, {-250, 150, 0}, 0.5, 0.6}})};
}

}  // namespace sinew::study
