// Rows 45–48, 52–54 and figures: muscles, their limits, and the way between animation and physics.
#include <algorithm>
#include <cmath>
#include <random>

#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"
#include "study/humanoid.h"
#include "study/mannequin.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Plays the mannequin's walk with its muscles scaled by `strength`.
template <class T>
Verdict walk_cycle(const Trial& t) {
  const Asset* asset = mannequin();
  const int clip = asset ? asset->find_clip("walk") : -1;
  if (clip < 0) {
    Verdict v({});
    v.require(false, "assets/character/mannequin.glb has no walk");
    return v;
  }
  Stage<T> stage(WorldSettings{});
  std::vector<JointJet<T>> jets(asset->skeleton.joints.size());
  const auto sample = [&](double time) { SamplingJob<T>{&asset->clips[clip], time, 1, jets}.Run(); };
  sample(0);
  CharacterSettings strong;
  strong.strength = 3;
  stage.add(asset->skeleton, strong, jets);
  double off = 0;
  int playing = 0;
  stage.run(4, t.h, [&](double time) {
    if (time > 0) {
      for (std::size_t i = 0; i < jets.size(); ++i)
        off = std::max(off, double(stage.character(0).local()[i].rotation.angularDistance(jets[i].rotation)));
      playing += stage.character(0).report().unknown_dofs == 0;
    }
    sample(time + t.h);
    stage.character(0).set_target(jets);
  });
  Verdict v(stage.measured());
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("joint off the clip (rad)", off, 1e-5);
  v.at_least("share of frames that are playback", double(playing) / (v.measured().steps - 1), 0.95);
  return v;
}

/// A standing figure with a driven root whose right hand is pulled forward with a share of what its shoulder
/// can bear.
template <class T>
struct PulledArm {
  static constexpr double kLimit = 70;
  Skeleton body = humanoid();
  Stage<T> stage{WorldSettings{}};
  int hand = body.find("hand_r"), dof = 0;

  PulledArm() {
    stage.add(body, {});
    dof = stage.character(0).first_dof(body.find("upperarm_r")) + 1;
  }
  void pull(double share, double h) {
    const Transform<double> at = stage.character(0).model()[hand].template cast<double>();
    // Hanging straight, the lever about the shoulder is 0.29 + 0.26 + 0.07 m.
    stage.push(0, hand, at * body.joints[hand].center_of_mass, Vec3<double>(share * kLimit / 0.62 * h, 0, 0));
  }
  bool unknown() { return stage.character(0).unknown()[dof] != 0; }
  double torque() { return double(stage.character(0).torque()[dof]); }
};

template <class T>
Verdict ramp_through_limit(const Trial& t) {
  PulledArm<T> arm;
  int flips = 0;
  bool was = false;
  double jump = 0, before = 0;
  arm.stage.run(6, t.h, [&](double time) {
    if (time > 1.5 * t.h) jump = std::max(jump, std::abs(arm.torque() - before));
    flips += arm.unknown() != was;
    was = arm.unknown(), before = arm.torque();
    arm.pull(time < 3 ? 0.98 + 0.04 * time / 3 : 1.02 - 0.04 * (time - 3) / 3, t.h);
  });
  Verdict v(arm.stage.measured());
  v.sound();
  v.at_most("changes between clip and solver", flips, 2);
  v.at_most("torque's jump in a step (N m)", jump, 0.01 * PulledArm<T>::kLimit);
  return v;
}

/// A weightless link on a joint of the given type below a driven one, muscles `torque_plus` = 1.5 times
/// `torque_minus` (N·m, per axis), against which a couple turns.
template <class T>
struct TwistedLink {
  Skeleton body;
  Stage<T> stage{weightless()};
  Vec3<double> minus{20, 35, 12};

  explicit TwistedLink(JointType type, bool ellipsoidal = false, std::vector<Muscle> muscles = {})
      : body(chain({2, type, JointType::kFree, 0.3})) {
    body.joints[1].ellipsoidal_limit = ellipsoidal;
    body.muscles = std::move(muscles);
    for (int k = 0; k < dof_count(type); ++k) {
      body.joints[1].dofs[k].torque_minus = minus[k];
      body.joints[1].dofs[k].torque_plus = 1.5 * minus[k];
      body.joints[1].dofs[k].damping = 20;  // N·m·s/rad: what is too weak gives way slowly
    }
    stage.add(body, {});
  }
  /// Σ (torque/limit)² of a torque, square root.
  double load(const Vec3<double>& torque) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::pow(torque[k] / (torque[k] > 0 ? 1.5 * minus[k] : minus[k]), 2);
    return std::sqrt(sum);
  }
  /// Turns the link by a couple (N·m, world) that the muscles must answer; one step.
  bool twist(const Vec3<double>& couple, double h) {
    const Vec3<double> arm = 0.05 * couple.unitOrthogonal(),
                       force = couple.cross(arm) / (2 * arm.squaredNorm());
    const Vec3<double> at = stage.character(0).model()[1].translation.template cast<double>();
    stage.push(0, 1, at + arm, force * h);
    stage.push(0, 1, at - arm, -force * h);
    return stage.step(h);
  }
  Vec3<double> torque() {
    const auto all = stage.character(0).torque();
    Vec3<double> t = Vec3<double>::Zero();
    for (std::size_t k = 6; k < all.size(); ++k) t[static_cast<int>(k) - 6] = double(all[k]);
    return t;
  }
};

template <class T>
Verdict ellipsoidal_limit(const Trial& t) {
  Measurement measured;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double held = 0, over = 0, short_of = 0;
  for (int n = 0; n < 20; ++n) {
    const Vec3<double> way(normal(random), normal(random), normal(random));
    TwistedLink<T> link(JointType::kBall, true);
    const Vec3<double> strongest = way / link.load(-way);  // the muscles pull against it
    for (int k = 0; k < 20; ++k) link.twist(0.99 * strongest, t.h);
    held += link.stage.character(0).on_animation();
    for (int k = 0; k < 20; ++k) {
      link.twist(1.05 * strongest, t.h);
      over = std::max(over, link.load(link.torque()) - 1);
      if (k > 0) short_of = std::max(short_of, 1 - link.load(link.torque()));
    }
    measured.merge(link.stage.measured());
  }
  // Up and down through the limit in a slanting direction.
  TwistedLink<T> link(JointType::kBall, true);
  const Vec3<double> way(1, -2, 0.7), strongest = way / link.load(-way);
  int flips = 0;
  double jump = 0;
  bool was = false;
  Vec3<double> before = Vec3<double>::Zero();
  for (double time = 0; time < 6; time += t.h) {
    link.twist((time < 3 ? 0.98 + 0.04 * time / 3 : 1.02 - 0.04 * (time - 3) / 3) * strongest, t.h);
    const bool unknown = link.stage.character(0).unknown()[6] != 0;
    flips += unknown != was;
    if (time > 0) jump = std::max(jump, (link.torque() - before).norm() / strongest.norm());
    was = unknown, before = link.torque();
  }
  measured.merge(link.stage.measured());
  Verdict v(measured);
  v.sound();
  v.at_least("directions of 20 in which 99 % of the ellipsoid holds", held, 20);
  v.at_most("torque beyond the ellipsoid, share", over, 1e-4);  // rotation vector for axes, some mrad off
  v.at_most("torque short of the ellipsoid when overloaded, share", short_of, 0.01);
  v.at_most("changes between clip and solver", flips, 2);
  v.at_most("torque's jump in a step, share", jump, 0.01);
  return v;
}

/// A hinge whose own muscle pulls 30 N·m upwards and which two more, a group, strengthen by 20 and 5.
template <class T>
Verdict several_muscles(const Trial& t) {
  TwistedLink<T> link(JointType::kRevolute, false,
                      {{"long", "biceps", 1, 0, 4, 20}, {"short", "biceps", 1, 0, 0, 5}});
  Character<T> c = link.stage.character(0);
  const Vec3<double> axis = link.body.joints[1].axis;
  double beyond = 0;
  const auto strength = [&](double couple) {  // what the muscles answer with in the end, up to their limit
    for (int n = 0; n < 30; ++n) {
      link.twist(-couple * axis, t.h);
      beyond = std::max({beyond, double(c.muscle_torque(0)) - 20, double(c.muscle_torque(1)) - 5});
    }
    return link.torque()[0];
  };
  const double held = strength(54.5);
  const bool playing = c.on_animation();
  const double most = strength(57), shared = double(c.muscle_torque(0) + c.muscle_torque(1));
  c.set_group_strength("biceps", T(0));
  const double own = strength(57), weakened = std::abs(double(c.muscle_torque(0)));
  Verdict v(link.stage.measured());
  v.sound();
  v.require(playing, "54.5 N m of 55 are not held");
  v.at_most("torque held off what is asked (N m)", std::abs(held - 54.5), 1e-3);
  v.at_most("limit off the sum of the three (N m)", std::abs(most - 55), 1e-3);
  v.at_most("what the two give of it off their 25 N m", std::abs(shared - 25), 1e-3);
  v.at_most("a muscle beyond its own limit (N m)", beyond, 1e-4);
  v.at_most("limit with the group at 0 off the hinge's own (N m)", std::abs(own - 30), 1e-3);
  v.at_most("torque of a muscle at strength 0 (N m)", weakened, 0);
  return v;
}

template <class T>
Verdict limit_toggled_every_frame(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  Skeleton body = humanoid();
  make_frictionless(body);
  stage.add(body, settings);
  bool on = false;
  stage.run(5, t.h, [&](double) {
    stage.character(0).set_strength(T(on ? 1 : 0));
    on = !on;
  });
  Verdict v(stage.measured());
  v.general();
  return v;
}

template <class T>
Verdict pushed_figure(const Trial& t) {
  Measurement measured;
  for (const double strength : {0.1, 0.4, 1.5}) {
    Stage<T> stage(WorldSettings{});
    const Skeleton body = humanoid();
    CharacterSettings settings;
    settings.root = RootDrive::kFree;
    settings.strength = strength;
    stage.add(body, settings);
    const int chest = 0;
    stage.run(4, t.h, [&](double time) {
      if (time > 0.5 && time < 0.7)
        stage.push(0, chest, stage.character(0).model()[chest].translation.template cast<double>(),
                   Vec3<double>(400, 60, 0) * t.h);
    });
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("share of unconverged steps", v.measured().unconverged_share(), 1e-4);
  v.at_most("99th percentile of passes", v.measured().passes_percentile(0.99), 8);
  return v;
}

template <class T>
Verdict target_beyond_limit(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  Skeleton body = humanoid();
  const int elbow = body.find("forearm_l");
  body.joints[elbow].dofs[0].lower = -2.4;
  body.joints[elbow].dofs[0].upper = 0;
  stage.add(body, {});
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  double torque = 0;
  stage.run(5, t.h, [&](double time) {
    bend(body, jets, elbow, {0, std::min(0.6, time), 0});  // up to 0.6 rad too far
    jets[elbow].omega = Vec3<T>(0, time < 0.6 ? T(1) : T(0), 0);
    stage.character(0).set_target(jets);
    torque =
        std::max(torque, std::abs(double(stage.character(0).torque()[stage.character(0).first_dof(elbow)])));
  });
  Verdict v(stage.measured());
  v.sound();
  v.at_most("torque (N m)", torque, 60 * (1 + 1e-5));
  v.at_most("kinetic energy at the end (J)", v.measured().kinetic_end, 1e-3);
  return v;
}

template <class T>
Verdict target_through_wall(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  const Skeleton body = humanoid();
  stage.add(body, {});
  stage.add_obstacle(obstacle_box({0.5, 0, 1}, {0.2, 2, 1}));
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  const int arm = body.find("upperarm_l");
  stage.run(5, t.h, [&](double time) {
    bend(body, jets, arm, {0, -std::min(1.5, time), 0});  // forward, into the wall
    jets[arm].omega = Vec3<T>(0, time < 1.5 ? T(-1) : T(0), 0);
    stage.character(0).set_target(jets);
  });
  Verdict v(stage.measured());
  v.sound();
  const int hand = body.find("hand_l");
  v.at_most("hand beyond the wall's face (m)", double(stage.character(0).model()[hand].translation.x()) - 0.3,
            0);
  v.at_most("kinetic energy at the end (J)", v.measured().kinetic_end, 1e-3);
  return v;
}

template <class T>
Verdict ragdoll_and_back_each_second(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  const Skeleton body = humanoid();
  stage.add(body, {});
  int returned = 0, cycles = 0;
  const double lasting = t.lasting(3600, 30);
  bool was_limp = false;
  stage.run(lasting, t.h, [&](double time) {
    const bool is_limp = std::fmod(time, 2) < 0.5;
    if (is_limp && !was_limp && time > 1) ++cycles, returned += stage.character(0).on_animation();
    was_limp = is_limp;
    stage.character(0).set_strength(T(is_limp ? 0 : 1));
    if (is_limp)
      stage.push(0, 0, stage.character(0).model()[0].translation.template cast<double>(),
                 Vec3<double>(50, 20 * std::sin(time), 0) * t.h);
  });
  Verdict v(stage.measured());
  v.sound();
  v.require(returned == cycles, "back on the animation in " + std::to_string(returned) + " of " +
                                    std::to_string(cycles) + " cycles");
  return v;
}

template <class T>
Verdict ragdoll_hit_in_the_same_frame(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  Skeleton body = humanoid();
  for (const char* elbow : {"forearm_l", "forearm_r"}) {
    body.joints[body.find(elbow)].dofs[0].lower = -2.4;
    body.joints[body.find(elbow)].dofs[0].upper = 0;
  }
  stage.add(body, {});
  stage.run(1, t.h);
  stage.character(0).set_strength(T(0));
  stage.character(0).set_root_drive(RootDrive::kFree);
  const int hand = body.find("hand_r"), elbow = body.find("forearm_r");
  const Vec3<double> before = stage.character(0).model()[hand].translation.template cast<double>();
  stage.push(0, hand, before, {200, 0, 0});
  double fastest = 0, beyond = 0;
  Vec3<double> last = before;
  stage.run(3, t.h, [&](double) {
    const Vec3<double> now = stage.character(0).model()[hand].translation.template cast<double>();
    fastest = std::max(fastest, (now - last).norm() / t.h);
    last = now;
    const Quat<double> q = stage.character(0).local()[elbow].rotation.template cast<double>();
    const double angle = 2 * std::atan2(q.y(), q.w());
    beyond = std::max({beyond, angle, -2.4 - angle});
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("hand's speed (m/s), impulse over its mass", fastest, 200 / body.joints[hand].mass);
  v.at_most("elbow beyond its limit (rad)", beyond, 5 * kPi / 180);
  return v;
}

}  // namespace

std::vector<HardCase> muscle_cases() {
  return {
      {"walk_cycle",
       "45",
       "seed talk, animation",
       "pose = clip to 1e-5; 95 % of the frames are playback",
       {1.0 / 60},
       walk_cycle<float>,
       walk_cycle<double>},
      {"ramp_through_limit",
       "46",
       "seed talk; research 1.6",
       "one hand-over per crossing, torque continuous to 1 %",
       {1.0 / 60},
       ramp_through_limit<float>,
       ramp_through_limit<double>},
      {"limit_toggled_every_frame",
       "47",
       "drake#20550",
       "no energy beyond the muscles' work",
       {1.0 / 60},
       limit_toggled_every_frame<float>,
       limit_toggled_every_frame<double>},
      {"several_muscles_on_a_joint",
       "48",
       "mujoco#2748",
       "limits add up; no muscle beyond its own; group at strength 0",
       {1.0 / 60},
       several_muscles<float>,
       several_muscles<double>},
      {"ellipsoidal_limit",
       "figure",
       "issue 3",
       "torques fill the ellipsoid; one hand-over per crossing",
       {1.0 / 60},
       ellipsoidal_limit<float>,
       ellipsoidal_limit<double>},
      {"pushed_figure",
       "figure",
       "solver-prototype",
       "p99 of passes 8, 0.01 % unconverged",
       {1.0 / 60},
       pushed_figure<float>,
       pushed_figure<double>},
      {"target_beyond_limit",
       "52",
       "o3de#1812; mujoco#96",
       "torque bounded, comes to rest",
       {1.0 / 60},
       target_beyond_limit<float>,
       target_beyond_limit<double>},
      {"target_through_wall",
       "52",
       "bullet3#1056",
       "penetration bounded, comes to rest",
       {1.0 / 60},
       target_through_wall<float>,
       target_through_wall<double>},
      {"ragdoll_and_back_each_second",
       "53",
       "shock2quest PR #301",
       "back on the animation every time",
       {1.0 / 60},
       ragdoll_and_back_each_second<float>,
       ragdoll_and_back_each_second<double>},
      {"ragdoll_hit_in_the_same_frame",
       "53b",
       "PhysX#366",
       "limit overshoot below 5 deg",
       {1.0 / 30},
       ragdoll_hit_in_the_same_frame<float>,
       ragdoll_hit_in_the_same_frame<double>},
  };
}

}  // namespace sinew::study
