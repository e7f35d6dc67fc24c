#include "study/random_trees.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"

namespace sinew::study {
namespace {

constexpr int kSteps = 100;
constexpr int kMostDofs = 60;

// Of the most kinetic energy that the tree ever has
constexpr double kMostGain = 1e-3;  ///< above what it began with
constexpr double kMostRise = 0.03;  ///< in one step: what swings in flight has 2 % (EnergyBalance)

/// Uniform and normal numbers that are the same on every platform (the standard's distributions are not).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  Vec3<double> vector(double scale) {
    return {uniform(-scale, scale), uniform(-scale, scale), uniform(-scale, scale)};
  }
  Vec3<double> unit() {
    for (;;) {
      const Vec3<double> v = vector(1);
      if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

Skeleton random_tree(std::uint64_t seed) {
  Dice dice(seed);
  const int wanted = 1 + dice.below(kMostDofs);
  constexpr JointType kinds[] = {JointType::kRevolute,  JointType::kRevolute,  JointType::kBall,
                                 JointType::kUniversal, JointType::kPrismatic, JointType::kFixed};
  Skeleton s;
  s.name = "tree " + std::to_string(seed);
  int dofs = 0;
  while (dofs < wanted) {
    const int i = static_cast<int>(s.joints.size());
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i == 0 ? -1 : std::max(0, i - 1 - dice.below(3));
    joint.type = i == 0 && wanted >= 6 ? JointType::kFree : kinds[dice.below(i == 0 ? 3 : 6)];
    if (dofs + dof_count(joint.type) > wanted) joint.type = JointType::kRevolute;
    dofs += dof_count(joint.type);
    joint.axis = dice.unit();
    joint.axis2 = joint.axis.unitOrthogonal();
    joint.rest.translation = dice.vector(0.3);
    joint.rest.rotation = rotation_exp<double>(dice.vector(1.5));
    joint.mass = std::pow(10, dice.uniform(-4, 4));
    joint.center_of_mass = dice.vector(0.1);
    const Vec3<double> extent(dice.uniform(0.02, 0.3), dice.uniform(0.02, 0.3), dice.uniform(0.02, 0.3));
    const Mat3<double> axes = rotation_exp<double>(dice.vector(1.5)).toRotationMatrix();
    const Mat3<double> inertia = axes * box_inertia(joint.mass, extent).asDiagonal() * axes.transpose();
    joint.inertia = 0.5 * (inertia + inertia.transpose());
    s.joints.push_back(joint);
    if (dice.below(2)) {
      Collider& c = s.colliders.emplace_back();
      c.joint = i;
      c.shape = dice.below(2) ? Shape::kSphere : Shape::kCapsule;
      c.size = {dice.uniform(0.02, 0.1), 0.05, dice.uniform(0.02, 0.15)};
      c.friction = dice.uniform(0, 1);
    }
  }
  s.body_count = static_cast<int>(s.joints.size());
  make_frictionless(s);
  return s;
}

namespace {

/// Lowest that a collider reaches (by its bounding sphere) at the given joint poses, m.
template <class T>
double lowest_point(const Skeleton& tree, const std::vector<JointJet<T>>& jets) {
  std::vector<Transform<double>> model(tree.joints.size());
  double lowest = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    model[i] = {jets[i].rotation.template cast<double>(), jets[i].translation.template cast<double>()};
    if (tree.joints[i].parent >= 0)
      model[i] = model[static_cast<std::size_t>(tree.joints[i].parent)] * model[i];
  }
  for (const Collider& c : tree.colliders) {
    const Vec3<double> center = model[static_cast<std::size_t>(c.joint)] * c.local.translation;
    lowest = std::min(lowest, center.z() - c.size.x() - c.size.z());
  }
  return lowest;
}

/// What is no gain yet, J: 1 µJ, and that a tree's height is known to a few roundings of T, as EnergyBalance
/// allows. Matters where next to nothing moves: a hinge of 0.6 kg that swings with 0.4 mJ, 1 m up (seed 9005
/// in float).
template <class T>
double noise_of(const Energy& start) {
  return 1e-6 + 4 * double(std::numeric_limits<T>::epsilon()) * std::abs(start.kinetic + start.potential);
}

/// The tree of a seed, thrown.
template <class T>
Measurement throw_tree(std::uint64_t seed, double& h, double& noise) {
  const Skeleton tree = random_tree(seed);
  Dice dice(~seed);
  WorldSettings settings;
  h = 1 / dice.uniform(30, 240);
  Stage<T> stage(settings);
  std::vector<JointJet<T>> jets = rest_jets<T>(tree);
  randomise_speeds(tree, jets, dice.uniform(0, 5), static_cast<unsigned>(seed));
  // Nothing begins in the floor: leading it out would be work.
  jets[0].translation.z() += T(1 + std::max(0.0, -lowest_point<T>(tree, jets)));
  stage.add(tree, passive(), jets);
  noise = noise_of<T>(energy_of<T>(tree, jets, settings.gravity));
  for (int n = 0; n < kSteps && stage.step(h); ++n) {
  }
  return stage.measured();
}

}  // namespace

template <class T>
TreeFaults faults_of_tree(std::uint64_t seed, Measurement& measured) {
  double h = 0, noise = 0;
  const Measurement m = throw_tree<T>(seed, h, noise);
  measured.merge(m);
  const std::string step = " at h = 1/" + std::to_string(std::lround(1 / h)) + " s";
  char what[160] = "";
  if (!m.refused.empty())
    std::snprintf(what, sizeof what, "refused: %s", m.refused.c_str());
  else if (!m.finite)
    std::snprintf(what, sizeof what, "NaN or infinity");
  else if (m.joint_gap > 1e-4)  // float's rounding at the end of a chain that has fallen 15 m
    std::snprintf(what, sizeof what, "joint gap %.2g m", m.joint_gap);
  if (*what) return {what, {}};
  if (m.leap > kMostGain * m.kinetic_most + noise) {
    std::snprintf(what, sizeof what, "leaps: a step's way needs %.3g J more than there is, %.3g J kinetic%s",
                  m.leap, m.kinetic_most, step.c_str());
    return {{}, what};
  }
  if (m.energy_gain > kMostGain * m.kinetic_most + noise)
    std::snprintf(what, sizeof what, "gains %.3g J of %.3g J%s", m.energy_gain, m.kinetic_most, step.c_str());
  else if (m.worst_rise > kMostRise * m.kinetic_most + noise)
    std::snprintf(what, sizeof what, "gains %.3g J of %.3g J in a step%s", m.worst_rise, m.kinetic_most,
                  step.c_str());
  return {what, {}};
}

template <class T>
RandomTreesReport run_random_trees(std::uint64_t first, int count, int threads) {
  std::vector<Measurement> measured(static_cast<std::size_t>(threads));
  std::vector<TreeFaults> faults(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::vector<std::thread> pool;
  for (int worker = 0; worker < threads; ++worker)
    pool.emplace_back([&, worker] {
      for (int n = next++; n < count; n = next++)
        faults[static_cast<std::size_t>(n)] = faults_of_tree<T>(first + static_cast<std::uint64_t>(n),
                                                                measured[static_cast<std::size_t>(worker)]);
    });
  for (std::thread& thread : pool) thread.join();
  RandomTreesReport report;
  report.count = count;
  for (const Measurement& m : measured) report.measured.merge(m);
  for (int n = 0; n < count; ++n) {
    const TreeFaults& f = faults[static_cast<std::size_t>(n)];
    const std::string seed = "seed " + std::to_string(first + static_cast<std::uint64_t>(n)) + ": ";
    if (!f.fault.empty()) report.faults.push_back(seed + f.fault);
    if (!f.leap.empty()) report.leaps.push_back(seed + f.leap);
  }
  return report;
}

template TreeFaults faults_of_tree<float>(std::uint64_t, Measurement&);
template TreeFaults faults_of_tree<double>(std::uint64_t, Measurement&);
template RandomTreesReport run_random_trees<float>(std::uint64_t, int, int);
template RandomTreesReport run_random_trees<double>(std::uint64_t, int, int);

}  // namespace sinew::study
