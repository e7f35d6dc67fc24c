// Runs one effect on so many joints, for `sinew study effects` to count instructions and time of.
//
//     sinew-effect-cost MODE EFFECT INSTANCES STEPS
//
// The figure is a wheel of 64 rods on hinges about a fixed hub, the same all the way round, so that cost
// could be linear in the rods that an effect acts on. What is counted happens in count_here(). Modes:
//
//     checked  World::step of a figure on its animation: residual, comparison, playback
//     bare     only kinematics and residual of that figure
//     pass     energy, gradient and matrix of one Newton pass over all 64 unknowns
//     solve    a solve of one pass, for contacts
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "sinew/character/world.h"
#include "sinew/optimizer/newton.h"
#include "study/effect_cost/modules.h"

namespace sinew::study {
namespace {

constexpr int kRods = 64;
constexpr float kStep = 1 / 60.f;

/// Terms that the solver has built in, on the first so many rods.
struct BuiltIn {
  int muscles = 0, limits = 0, damping = 0, dry_friction = 0, contacts = 0;
};

Skeleton wheel(const BuiltIn& on) {
  Skeleton s;
  s.name = "wheel";
  Joint hub;
  hub.name = "hub";
  hub.mass = 1;
  hub.inertia.setIdentity();
  s.joints.push_back(hub);
  for (int i = 0; i < kRods; ++i) {
    Joint rod;
    rod.name = "rod" + std::to_string(i);
    rod.parent = 0;
    rod.type = JointType::kRevolute;
    rod.rest.rotation = Eigen::AngleAxisd(2 * 3.14159265358979 * i / kRods, Vec3<double>::UnitZ());
    rod.axis = Vec3<double>::UnitY();
    rod.mass = 1;
    rod.center_of_mass = {0.5, 0, 0};
    rod.inertia = Vec3<double>(0.001, 0.08, 0.08).asDiagonal();
    DofLimits& dof = rod.dofs[0];
    dof.torque_minus = dof.torque_plus = i < on.muscles ? 1e6 : 0;
    dof.dry_friction = i < on.dry_friction ? 1 : 0;
    dof.damping = i < on.damping ? 1 : 0;
    if (i < on.limits) dof.lower = 0.1;  // borne at angle 0
    s.joints.push_back(rod);
    Collider capsule;
    capsule.joint = i + 1;
    capsule.shape = Shape::kCapsule;
    capsule.local = {Quat<double>::FromTwoVectors(Vec3<double>::UnitZ(), Vec3<double>::UnitX()), {0.5, 0, 0}};
    capsule.size = {0.05, 0.05, 0.4};
    s.colliders.push_back(capsule);
  }
  s.body_count = static_cast<int>(s.joints.size());
  return s;
}

std::vector<std::string> first_rods(int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back("rod" + std::to_string(i));
  if (count == 0) names.emplace_back("hub");  // declared where there is nothing to act on
  return names;
}

std::vector<JointJet<float>> at_rest(const Skeleton& s) {
  std::vector<JointJet<float>> jets(s.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation.cast<float>();
    jets[i].translation = s.joints[i].rest.translation.cast<float>();
  }
  return jets;
}

WorldSettings nothing_declared() {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  return settings;
}

/// What is run, once per step.
struct Work {
  virtual ~Work() = default;
  virtual void step() = 0;
  virtual std::size_t bytes() const { return 0; }
};

struct Checked : Work {
  World<float> world{nothing_declared()};
  std::size_t effect_bytes = 0;

  Checked(const std::string& effect, int instances) {
    Status status;
    const Skeleton s = wheel({.muscles = kRods});
    if (world.add_character(s, {}, status) < 0) std::abort();
    (void)world.character(0).set_target(at_rest(s));
    world.character(0).reset();
    if (effect == "none") return;
    auto made = make_module(effect, first_rods(instances));
    if (!made) std::exit(3);
    const Effect<float>& declared = *made;
    if (!world.add_effect(0, std::move(made))) std::abort();
    effect_bytes = declared.bytes();
  }
  void step() override { (void)world.step(kStep); }
  std::size_t bytes() const override { return effect_bytes; }
};

struct Bare : Work {
  Skeleton skeleton = wheel({});
  Tree<float> tree{skeleton};
  std::vector<JointJet<float>> jets = at_rest(skeleton);
  Kinematics<float> kinematics{tree};
  Motion<float> motion{tree};
  std::vector<Vec3<float>> force{jets.size()}, moment{jets.size()};
  std::vector<float> torque = std::vector<float>(tree.dofs);

  void step() override {
    inertial_wrenches<float>(tree, jets, Vec3<float>::Zero(), Vec3<float>::Zero(), kinematics, motion, force,
                             moment);
    project_wrenches<float>(tree, kinematics, force, moment, torque);
  }
};

struct Solving : Work {
  Skeleton skeleton;
  Tree<float> tree;
  TreeProblem<float> problem;
  std::unique_ptr<Effect<float>> effect;
  History<float> history;
  StepSettings<float> settings;
  TreeProblem<float>* trees[1] = {&problem};

  Solving(const std::string& name, int instances)
      : skeleton(wheel(built_in(name, instances))),
        tree(skeleton),
        problem(tree, skeleton),
        history(tree.bodies) {
    settings.gravity.setZero();
    settings.h = kStep;
    for (int i = 0; i < tree.bodies; ++i) problem.start[i] = problem.target[i] = tree.rest[i];
    problem.local = problem.start;
    std::fill(problem.free.begin(), problem.free.end(), std::uint8_t{1});
    if (auto made = make_module(name, first_rods(instances))) {
      effect = std::move(made);
      if (!effect->attach(skeleton, tree)) std::abort();
      problem.plan(*effect);
    }
    forward_kinematics<float>(tree, problem.start, Vec3<float>::Zero(), problem.kinematics);
    const Motion<float> still(tree);
    advance_exactly<float>(tree, problem.kinematics, still, kStep, Vec3<double>::Zero(), history);
    history.stop();
    predict<float>(tree, history, Scheme::kBdf1, kStep, Vec3<double>::Zero(), problem.prediction);
  }
  static BuiltIn built_in(const std::string& name, int count) {
    if (name == "muscles") return {.muscles = count};
    if (name == "joint_limits") return {.limits = count};
    if (name == "joint_damping") return {.damping = count};
    if (name == "dry_friction") return {.dry_friction = count};
    return {};
  }
  std::size_t bytes() const override { return effect ? effect->bytes() : 0; }
};

struct Pass : Solving {
  InnerProblem<float> inner;

  Pass(const std::string& name, int instances) : Solving(name, instances) {
    SolveRoom room = room_of(tree, 0, 0, 0);
    room.effect_rows = effect ? effect->most_rows() : 0;
    inner.reserve(room);
    inner.begin(settings, trees);
  }
  void step() override {
    for (Effect<float>* e : problem.effects) e->begin_step(effect_pose(settings, problem));
    begin_evaluation(settings, problem);
    finish_gradient(problem);
    inner.build({}, {}, true);
  }
};

/// Every rod's tip rests 1 mm deep on the floor and is held by friction.
struct OnePass : Solving {
  NewtonSolver<float> solver;
  Accuracy once;
  std::vector<Contact<float>> contacts, fresh;

  OnePass(const std::string& name, int instances) : Solving(name, instances) {
    problem.room = room_of(tree, kRods, kRods, 0);
    solver.reserve(problem.room);
    once.max_iterations = 1;
    for (int i = 0; i < instances; ++i) {
      Contact<float> c;
      c.body_a = i + 1;
      c.local_a = {1, 0, 0};
      c.radius = 0.05f;
      c.plane = true;
      c.plane_height = -0.049f;
      c.lagged_normal_force = 5;
      begin_step<float>(problem.kinematics, nullptr, c);
      fresh.push_back(c);
    }
  }
  void step() override {
    contacts = fresh;
    problem.local = problem.start;
    (void)solver.solve(settings, once, trees, contacts);
  }
  std::size_t bytes() const override { return fresh.size() * sizeof(Contact<float>); }
};

std::unique_ptr<Work> make_work(const std::string& mode, const std::string& effect, int instances) {
  if (mode == "checked") return std::make_unique<Checked>(effect, instances);
  if (mode == "bare") return std::make_unique<Bare>();
  if (mode == "pass") return std::make_unique<Pass>(effect, instances);
  if (mode == "solve") return std::make_unique<OnePass>(effect, instances);
  std::exit(2);
}

}  // namespace
}  // namespace sinew::study

/// Named for callgrind's --toggle-collect.
extern "C" [[gnu::noinline]] void count_here(sinew::study::Work& work, int steps) {
  for (int n = 0; n < steps; ++n) work.step();
}

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: sinew-effect-cost checked|bare|pass|solve EFFECT INSTANCES STEPS\n", stderr);
    return 2;
  }
  const int instances = std::atoi(argv[3]), steps = std::atoi(argv[4]);
  const auto work = sinew::study::make_work(argv[1], argv[2], instances);
  for (int n = 0; n < 4; ++n) work->step();  // caches, and what a first step does differently
  const auto begin = std::chrono::steady_clock::now();
  count_here(*work, steps);
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
  std::printf("%.6f %zu\n", time.count() / steps, work->bytes());
}
