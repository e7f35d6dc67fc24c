// Parts of a step: the residual alone, one Newton pass, a solve of one pass.
#include <cmath>
#include <cstdlib>

#include "sinew/optimizer/newton.h"
#include "study/effect_cost/figure.h"
#include "study/effect_cost/modules.h"
#include "study/effect_cost/work.h"

namespace sinew::study {
namespace {

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

struct Solving {
  Skeleton skeleton;
  Tree<float> tree;
  TreeProblem<float> problem;
  std::unique_ptr<Effect<float>> effect;
  History<float> history;
  StepPlan<float> plan;
  StepSettings<float> settings;
  TreeProblem<float>* trees[1] = {&problem};

  Solving(const std::string& name, int instances, double height = 0)
      : skeleton(wheel(built_in(name, instances), height)),
        tree(skeleton),
        problem(tree, skeleton),
        history(tree.bodies) {
    settings.gravity.setZero();
    settings.h = kStep;
    for (int i = 0; i < tree.bodies; ++i) problem.start[i] = problem.target[i] = tree.rest[i];
    problem.local = problem.start;
    std::fill(problem.free.begin(), problem.free.end(), std::uint8_t{1});
    declare_term(name, plan);
    settings.plan = &plan;
    if (auto made = make_module(name, first_rods(instances))) {
      effect = std::move(made);
      if (!effect->attach(skeleton, tree)) std::abort();
      problem.plan(*effect);
    }
    forward_kinematics<float>(tree, problem.start, Vec3<float>::Zero(), problem.kinematics);
    const Motion<float> still(tree);
    advance_exactly<float>(tree, problem.kinematics, still, kStep, Vec3<float>::Zero(), Vec3<double>::Zero(),
                           history);
    history.stop();
    predict_euler<float>(tree, history, kStep, Vec3<double>::Zero(), problem.prediction);
  }
  static BuiltIn built_in(const std::string& name, int count) {
    if (name == "muscles") return {.muscles = count};
    if (name == "joint_limits") return {.limits = count};
    if (name == "joint_damping") return {.damping = count};
    if (name == "dry_friction") return {.dry_friction = count};
    return {};
  }
};

struct Pass : Work, private Solving {
  InnerProblem<float> inner;

  Pass(const std::string& name, int instances) : Solving(name, instances) {
    SolveCapacity capacity = capacity_of(tree, 0, 0, 0);
    capacity.effect_rows = effect ? effect->most_rows() : 0;
    inner.declare(plan);
    inner.reserve(capacity);
    inner.begin(settings, trees);
  }
  void step() override {
    for (Effect<float>* e : problem.effects) e->begin_step(effect_pose(settings, problem));
    begin_evaluation(settings, problem);
    finish_gradient(problem);
    inner.build({}, {}, true);
  }
  std::size_t bytes() const override { return effect ? effect->bytes() : 0; }
};

/// Rods that rest 1 mm deep on something, held by friction: on the floor, on a box, on the next rod of the
/// wheel, on the rods of a second wheel below.
struct OnePass : Work, private Solving {
  std::unique_ptr<Solving> below;
  NewtonSolver<float> solver;
  Accuracy once;
  std::vector<TreeProblem<float>*> all{&problem};
  std::vector<Contact<float>> contacts, fresh;

  OnePass(const std::string& name, int instances) : Solving(name, instances) {
    once.max_iterations = 1;
    solver.declare(plan);
    problem.capacity = capacity_of(tree, kRods, 2 * kRods, 0);
    SolveCapacity capacity = problem.capacity;
    if (name == "character_contact") {
      below = std::make_unique<Solving>("none", 0, -0.099);
      below->problem.capacity = problem.capacity;
      all.push_back(&below->problem);
      capacity += problem.capacity;
    }
    solver.reserve(capacity);
    for (int i = 0; i < instances; ++i) {
      fresh.push_back(contact(name, i));
      const Kinematics<float>& other = below ? below->problem.kinematics : problem.kinematics;
      begin_contact(problem.kinematics, fresh.back().tree_b < 0 ? nullptr : &other, fresh.back());
    }
  }
  static Contact<float> contact(const std::string& name, int rod) {
    Contact<float> c;
    c.body_a = rod + 1;
    c.local_a = {1, 0, 0};
    c.radius = 0.05f;
    c.lagged_normal_force = 5;
    c.grip = c.friction * c.lagged_normal_force;
    if (name == "ground") {
      c.plane = true;
      c.plane_height = -0.049f;
      return c;
    }
    if (name == "obstacle") {
      c.shape = Shape::kBox;
      c.size = {2, 2, 1};
      c.shape_pose.translation = {0, 0, -1.049f};
      return c;
    }
    const Collider capsule = rod_capsule();
    c.shape = capsule.shape;
    c.size = capsule.size.cast<float>();
    c.shape_pose = capsule.local.cast<float>();
    if (name == "character_contact") {
      c.tree_b = 1;
      c.body_b = rod + 1;
      c.local_a = {0.85f, 0, 0};
    } else if (name == "self_collision") {  // 0.099 m above the next rod's axis
      c.tree_b = 0;
      c.body_b = (rod + 1) % kRods + 1;
      c.local_a = {0.85f * std::cos(kRodAngle), 0.85f * std::sin(kRodAngle), 0.099f};
    } else {
      unknown(name);
    }
    return c;
  }
  void step() override {
    contacts = fresh;
    problem.local = problem.start;
    if (below) below->problem.local = below->problem.start;
    (void)solver.solve(settings, once, all, contacts);
  }
  std::size_t bytes() const override { return fresh.size() * sizeof(Contact<float>); }
};

}  // namespace

std::unique_ptr<Work> make_kernel(const std::string& mode, const std::string& effect, int instances) {
  if (mode == "bare") return std::make_unique<Bare>();
  if (mode == "pass") return std::make_unique<Pass>(effect, instances);
  if (mode == "solve") return std::make_unique<OnePass>(effect, instances);
  return nullptr;
}

}  // namespace sinew::study
