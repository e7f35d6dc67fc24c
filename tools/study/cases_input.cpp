// Rows 55–66: steps, absurd numbers, distance, repeatability, endurance.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "scene/humanoid.h"
#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"
#include "study/random_trees.h"
#include "study/soak.h"

namespace sinew::study {
namespace {

template <class T>
std::vector<Transform<T>> pose(Stage<T>& stage, int character = 0) {
  const auto model = stage.character(character).model();
  return {model.begin(), model.end()};
}

template <class T>
bool same_bits(const std::vector<Transform<T>>& a, const std::vector<Transform<T>>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
           return x.rotation.coeffs() == y.rotation.coeffs() && x.translation == y.translation;
         });
}

/// A thrown figure's pose after a second and a half of steps of h, and whether every step that cannot be
/// taken was refused in between where `disturbed`. Steps of 10 µs, the shortest, follow.
template <class T>
std::vector<Transform<T>> refusing(const scene::Scene& scene, bool disturbed, double h, Measurement& measured,
                                   bool& refused) {
  Stage<T> stage(scene);
  stage.run(0.5, h);
  // 1 ns is refused, not gathered: what is left of it is the host's to add to its next step.
  if (disturbed)
    for (const T bad : {T(0), T(-1) / 60, T(1e-9), std::numeric_limits<T>::quiet_NaN(),
                        std::numeric_limits<T>::infinity(), T(1)})
      refused = refused && !stage.world().step(bad).ok();
  stage.run(1, h);
  const auto after = pose(stage);
  stage.run(50e-5, 1e-5);
  measured.merge(stage.measured());
  return after;
}

template <class T>
Verdict zero_negative_tiny_step(const Trial& t) {
  Measurement measured;
  bool refused = true;
  const auto plain = refusing<T>(t.scene, false, t.h, measured, refused);
  const bool kept = same_bits(plain, refusing<T>(t.scene, true, t.h, measured, refused));
  Verdict v(measured);
  v.require(refused, "a step that cannot be taken was taken");
  v.require(kept, "a refused step moved something");
  v.general();
  return v;
}

template <class T>
Verdict huge_step(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 5u : 20u); ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene);
    stage.run(4, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("energy without work (J)", v.measured().energy_gain, 1e-3 * v.measured().kinetic_most);
  return v;
}

template <class T>
Verdict random_steps(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 4u : 20u); ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> h(1.0 / 240, 1.0 / 20);
    for (double time = 0; time < 4;) {
      const double step = h(random);
      if (!stage.step(step)) break;
      time += step;
    }
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  return v;
}

/// Two figures; `spoil` feeds the first one nonsense in every step. The second one's pose.
template <class T, class Spoil>
std::vector<Transform<T>> neighbour(const scene::Scene& scene, double h, Measurement& measured, Spoil spoil) {
  Stage<T> stage(scene);
  stage.run(2, h, [&](double) { spoil(stage); });
  measured.merge(stage.measured());
  return pose(stage, 1);
}

template <class T>
Verdict absurd_numbers(const Trial& t) {
  Measurement measured;
  const auto plain = neighbour<T>(t.scene, t.h, measured, [](Stage<T>&) {});
  bool refused = true;
  const auto spoilt = neighbour<T>(t.scene, t.h, measured, [&](Stage<T>& stage) {
    Character<T> c = stage.character(0);
    const T nan = std::numeric_limits<T>::quiet_NaN(), infinite = std::numeric_limits<T>::infinity();
    const T absurd = sizeof(T) == 8 ? T(1e300) : T(1e38);
    std::vector<JointJet<T>> jets = rest_jets<T>(c.skeleton());
    for (const T bad : {nan, infinite, absurd}) {
      refused = refused && !c.apply_impulse(3, {T(0), T(0), T(1)}, {bad, T(0), T(0)}).ok();
      jets[4].omega.x() = bad;
      const Status status = c.set_target(jets);
      refused = refused && !status.ok() && status.index == 4;
    }
    refused = refused && !c.set_strength(nan).ok();
  });
  Verdict v(measured);
  v.general();
  v.require(refused, "an absurd number was not refused by its joint");
  v.require(same_bits(plain, spoilt), "another character's bits changed");
  return v;
}

template <class T>
Verdict denormal_speeds(const Trial& t) {
  const auto balls = [](bool denormal) {
    auto stage = std::make_unique<Stage<T>>(weightless());
    for (int i = 0; i < 300; ++i) {
      PropSettings ball;
      ball.pose.translation = {10.0 * i, 0, 0};
      if (denormal) ball.velocity = Vec3<double>::Constant(sizeof(T) == 4 ? 1e-41 : 1e-310);
      stage->add_prop(ball);
    }
    return stage;
  };
  const std::unique_ptr<Stage<T>> zero = balls(false), denormal = balls(true);
  // In turns, so that what else the machine does meets both.
  std::vector<double> ratios;
  for (int turn = 0; turn < (t.quick ? 2 : 100); ++turn) {
    double microseconds[2];
    for (Stage<T>* stage : {zero.get(), denormal.get()}) {
      const double before = stage->measured().microseconds;
      stage->run(0.1, t.h);
      microseconds[stage == denormal.get()] = stage->measured().microseconds - before;
    }
    ratios.push_back(microseconds[1] / microseconds[0]);
  }
  Measurement measured = zero->measured();
  measured.merge(denormal->measured());
  Verdict v(measured);
  v.general();
  std::nth_element(ratios.begin(), ratios.begin() + std::ssize(ratios) / 2, ratios.end());
  if (!t.quick) v.at_most("time against speeds of zero", ratios[ratios.size() / 2], 1.1);
  return v;
}

template <class T>
Verdict odd_quaternions(const Trial& t) {
  Stage<T> stage(t.scene);
  const Skeleton& body = t.scene.characters[0].asset->skeleton;
  bool refused = true;
  for (const T norm : {T(1.1), T(1e-20), T(0)}) {
    std::vector<JointJet<T>> jets = rest_jets<T>(body);
    jets[5].rotation.coeffs() *= norm;
    const Status status = stage.character(0).set_target(jets);
    refused = refused && !status.ok() && status.index == 5;
  }
  stage.run(1, t.h);
  Verdict v(stage.measured());
  v.require(refused, "a rotation that is no unit quaternion was not refused by its joint");
  v.general();
  return v;
}

/// Joints relative to the root after a second of limp flight that began `away` metres from the origin.
template <class T>
std::vector<Vec3<double>> flown_away(scene::Scene scene, double away, double h, Measurement& measured) {
  scene.characters[0].position += Vec3<double>(away, away, 0);
  Stage<T> stage(scene);
  const Skeleton& body = scene.characters[0].asset->skeleton;
  stage.run(1, h);
  measured.merge(stage.measured());
  // Composed from the local transforms, so that only the motion counts, not how a place is rounded.
  std::vector<Vec3<double>> joints;
  std::vector<Transform<double>> model(body.joints.size());
  for (std::size_t i = 0; i < body.joints.size(); ++i) {
    Transform<double> local = stage.character(0).local()[i].template cast<double>();
    if (i == 0) local.translation.setZero();
    model[i] = body.joints[i].parent < 0 ? local : model[body.joints[i].parent] * local;
    joints.push_back(model[i].translation);
  }
  return joints;
}

template <class T, int kilometres>
Verdict far_from_origin(const Trial& t) {
  Measurement measured;
  const auto here = flown_away<T>(t.scene, 0, t.h, measured);
  const auto there = flown_away<T>(t.scene, 1000.0 * kilometres, t.h, measured);
  double apart = 0;
  for (std::size_t i = 0; i < here.size(); ++i) apart = std::max(apart, (here[i] - there[i]).norm());
  Verdict v(measured);
  v.require(v.measured().finite, "NaN or infinity");
  v.at_most("pose off the one at the origin (m)", apart, 1e-4);
  return v;
}

/// The scene's figures put into the world in another order; the pose of figure `asked`.
template <class T>
std::vector<Transform<T>> in_order(scene::Scene scene, const std::array<int, 3>& order, int asked, double h,
                                   Measurement& measured) {
  const std::vector<scene::SceneCharacter> cast = scene.characters;
  for (std::size_t place = 0; place < order.size(); ++place) scene.characters[place] = cast[order[place]];
  Stage<T> stage(scene);
  stage.run(2, h);
  measured.merge(stage.measured());
  return pose(stage, static_cast<int>(std::find(order.begin(), order.end(), asked) - order.begin()));
}

template <class T>
Verdict same_bits_in_any_order(const Trial& t) {
  Measurement measured;
  bool same = true;
  for (int who = 0; who < 3; ++who) {
    const auto first = in_order<T>(t.scene, {0, 1, 2}, who, t.h, measured);
    same = same && same_bits(first, in_order<T>(t.scene, {0, 1, 2}, who, t.h, measured));
    same = same && same_bits(first, in_order<T>(t.scene, {2, 0, 1}, who, t.h, measured));
  }
  Verdict v(measured);
  v.require(same, "bits depend on the run or the order of characters");
  return v;
}

/// A thrown figure and a ball, saved after two seconds, go on twice from there.
template <class T>
Verdict save_and_restore(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(2, t.h);
  std::vector<std::byte> saved(stage.world().snapshot_capacity());
  const std::size_t size = stage.world().save(saved);
  const auto go_on = [&] {
    stage.run(600 * t.h, t.h);
    const auto model = stage.character(0).model();
    return std::vector<Transform<T>>(model.begin(), model.end());
  };
  const auto first = go_on();
  const bool taken = stage.world().restore(std::span(saved).first(size)).ok();
  stage.forget();
  const bool same = same_bits(first, go_on());
  Verdict v(stage.measured());
  v.require(size > 0 && taken, "the snapshot is not taken back");
  v.require(same, "bits differ after 600 frames");
  return v;
}

/// A limp figure's pose after a second in the air, in steps of h that are cut into `substeps` parts.
template <class T>
std::vector<Transform<T>> flown_in_parts(scene::Scene scene, double h, int substeps, Measurement& measured,
                                         bool& counted) {
  Accuracy& accuracy = scene.world.accuracy = {};
  accuracy.substeps = substeps;
  if (sizeof(T) == 8) accuracy.tolerance = 1e-7;
  scene.characters[0].speeds.random = 2;
  Stage<T> stage(scene);
  stage.run(1, h, [&](double time) {
    if (time > 0) counted = counted && stage.character(0).report().substeps == substeps;
  });
  measured.merge(stage.measured());
  return pose(stage);
}

/// Parts that a step of a body turning at `speed` rad/s takes if no part may turn it by more than 0.25 rad.
template <class T>
int parts_of_turning_body(double speed, double h, Measurement& measured) {
  WorldSettings settings = weightless();
  settings.accuracy.max_rotation = 0.25;
  Stage<T> stage(settings);
  const Skeleton body = free_body(1, {0.02, 0.05, 0.06});
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  jets[0].omega = Vec3<T>(T(0.1), T(0.1), T(speed));
  stage.add(body, passive(), jets);
  stage.run(1, h);
  measured.merge(stage.measured());
  return stage.character(0).report().substeps;
}

template <class T>
Verdict substeps(const Trial& t) {
  Measurement measured;
  bool counted = true;
  const auto parts = flown_in_parts<T>(t.scene, t.h, 4, measured, counted);
  const auto steps = flown_in_parts<T>(t.scene, t.h / 4, 1, measured, counted);
  double apart = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    apart = std::max(apart, double((parts[i].translation - steps[i].translation).norm()));
  Verdict v(measured);
  v.general();
  v.require(counted, "the telemetry does not count the parts");
  v.at_most("four parts off four steps (m)", apart, 1e-3);
  v.at_most("parts of a step at 3 rad/s", parts_of_turning_body<T>(3, t.h, measured), 1);
  v.at_least("parts of a step at 60 rad/s", parts_of_turning_body<T>(60, t.h, measured), 4);
  return v;
}

template <class T>
Verdict momentum_scheme(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 3u : 20u); ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.random = 2;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene, Compared::kMomentum);
    stage.run(3, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  return v;
}

template <class T>
Verdict soak_hour(const Trial& t) {
  const SoakReport r = soak<T>(t.lasting(3600, 20), t.h, 1);
  Verdict v(r.measured);
  v.require(r.not_finite == 0, "frames with NaN: " + std::to_string(r.not_finite));
  v.at_most("heap grown (bytes)", double(r.heap_growth), 0);
  v.at_most("share of unconverged steps", r.measured.unconverged_share(), 1e-3);
  return v;
}

template <class T>
Verdict random_trees(const Trial& t) {
  const RandomTreesReport r = run_random_trees<T>(1, t.quick ? 300 : 20000, 4);
  Verdict v(r.measured);
  v.require(r.faults.empty(),
            r.faults.empty() ? "" : std::to_string(r.faults.size()) + " trees, first " + r.faults[0]);
  v.require(r.leaps.empty(), r.leaps.empty()
                                 ? ""
                                 : std::to_string(r.leaps.size()) + " of " + std::to_string(r.count) +
                                       " trees leap, first " + r.leaps[0]);
  return v;
}

}  // namespace

std::vector<HardCase> input_cases() {
  return {
      {"zero_negative_tiny_step",
       "55",
       "rapier#659; avian#622",
       "refused by status (0, < 0, 1 ns, 1 s, NaN), not a bit moved; 10 us works",
       {1.0 / 60},
       zero_negative_tiny_step<float>,
       zero_negative_tiny_step<double>},
      {"huge_step",
       "56",
       "drake cenic; seed talk",
       "finite, no energy gained",
       {1.0 / 10, 1.0 / 5},
       huge_step<float>,
       huge_step<double>,
       "",
       "limp_fall"},
      {"random_steps",
       "57",
       "bepuphysics2#46; liquidfun#86",
       "h anew in [1/240, 1/20] s every frame",
       {1.0 / 60},
       random_steps<float>,
       random_steps<double>,
       "",
       "limp_fall"},
      {"absurd_numbers",
       "58",
       "drake#19322",
       "refused by name; no other character's bits change",
       {1.0 / 60},
       absurd_numbers<float>,
       absurd_numbers<double>},
      {"denormal_speeds",
       "59",
       "glm#540; hyperion#150",
       "time within 10 % of speeds of zero",
       {1.0 / 60},
       denormal_speeds<float>,
       denormal_speeds<double>},
      {"odd_quaternions",
       "60",
       "mujoco NormalizeQuats",
       "norm 1.1, 1e-20 and 0 are refused by name",
       {1.0 / 60},
       odd_quaternions<float>,
       odd_quaternions<double>},
      {"10_km_from_origin",
       "61",
       "JoltPhysics#94, #344",
       "pose as at the origin to 0.1 mm",
       {1.0 / 60},
       far_from_origin<float, 10>,
       far_from_origin<double, 10>,
       "",
       "far_from_origin"},
      {"100_km_from_origin",
       "61",
       "bepuphysics2#13",
       "pose as at the origin to 0.1 mm",
       {1.0 / 60},
       far_from_origin<float, 100>,
       far_from_origin<double, 100>,
       "",
       "far_from_origin"},
      {"same_bits_in_any_order",
       "63",
       "Jolt PhysicsDeterminismTests",
       "same bits again and in any order",
       {1.0 / 60},
       same_bits_in_any_order<float>,
       same_bits_in_any_order<double>},
      {"save_and_restore",
       "64",
       "Jolt TestSelectiveStateSaveAndRestore",
       "same bits after 600 frames",
       {1.0 / 60},
       save_and_restore<float>,
       save_and_restore<double>},
      {"soak_hour",
       "65",
       "research 1.3",
       "in a crowd: no NaN, heap flat, 0.1 % unconverged",
       {1.0 / 60},
       soak_hour<float>,
       soak_hour<double>},
      {"random_trees",
       "66",
       "research 2f",
       "general, for every tree",
       {1.0 / 60},
       random_trees<float>,
       random_trees<double>},
      {"momentum_scheme",
       "figure",
       "issue 3",
       "the talk's literal residual: no energy gained",
       {1.0 / 60},
       momentum_scheme<float>,
       momentum_scheme<double>,
       "",
       "limp_fall"},
      {"substeps",
       "figure",
       "issue 3",
       "n parts as n steps; automatic by rotation; counted",
       {1.0 / 60},
       substeps<float>,
       substeps<double>,
       "",
       "free_flight"},
  };
}

}  // namespace sinew::study
