// Rows 45–48, 52–54 and figures: muscles, their limits, and the way between animation and physics.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// How a walk goes with muscles of some strength.
struct Walked {
  Measurement measured;
  double off = 0;     ///< rad, furthest that a joint is off the clip
  double played = 0;  ///< share of the frames that are playback
};

template <class T>
Walked walk(const Trial& t, double strength) {
  scene::Scene scene = t.scene;
  scene.characters[0].strength = {{0, strength}};
  Stage<T> stage(scene);
  scene::Player<T> clip(scene.characters[0]);
  std::vector<JointJet<T>> jets = clip.start(stage.character(0).local());
  double off = 0;
  int playing = 0;
  stage.run(4, t.h, [&](double time) {
    if (time > 0) {
      for (std::size_t i = 0; i < jets.size(); ++i)
        off = std::max(off, double(stage.character(0).local()[i].rotation.angularDistance(jets[i].rotation)));
      playing += stage.character(0).report().unknown_dofs == 0;
    }
    jets = clip.at(time + t.h, stage.character(0).local());
  });
  return {stage.measured(), off, double(playing) / (stage.measured().steps - 1)};
}

/// Plays the mannequin's walk with its muscles scaled by `percent`.
template <class T, int percent>
Verdict walk_cycle(const Trial& t) {
  const Walked walked = walk<T>(t, percent / 100.0);
  Verdict v(walked.measured);
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("joint off the clip (rad)", walked.off, 1e-5);
  v.at_least("share of frames that are playback", walked.played, 0.95);
  for (const double strength : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0}) {
    if (percent != 100 || t.quick || sizeof(T) == sizeof(float)) break;
    const Walked weaker = walk<T>(t, strength);
    char text[100];
    std::snprintf(text, sizeof text,
                  "at strength %.1f %.0f %% of the frames are playback, joints up to %.1f deg off", strength,
                  100 * weaker.played, weaker.off * 180 / kPi);
    v.note(text);
  }
  return v;
}

template <class T>
Verdict ramp_through_limit(const Trial& t) {
  Stage<T> stage(t.scene);  // hanging straight, the hand's lever about the shoulder is 0.29 + 0.26 + 0.07 m
  const Skeleton& body = t.scene.characters[0].asset->skeleton;
  const int shoulder = body.find("upperarm_r"), dof = stage.character(0).first_dof(shoulder) + 1;
  int flips = 0;
  bool was = false;
  double jump = 0, before = 0;
  stage.run(6, t.h, [&](double time) {
    const bool unknown = stage.character(0).unknown()[dof] != 0;
    const double torque = double(stage.character(0).torque()[dof]);
    if (time > 1.5 * t.h) jump = std::max(jump, std::abs(torque - before));
    flips += unknown != was;
    was = unknown, before = torque;
  });
  Verdict v(stage.measured());
  v.sound();
  v.at_most("changes between clip and solver", flips, 2);
  v.at_most("torque's jump in a step (N m)", jump, 0.01 * body.torque_limits(shoulder, 1)[1]);
  return v;
}

/// The scene's link on a joint below a driven one, against whose muscles a couple turns.
template <class T>
struct TwistedLink {
  Stage<T> stage;
  const Joint& joint;

  explicit TwistedLink(const scene::Scene& scene)
      : stage(scene), joint(scene.characters[0].asset->skeleton.joints[1]) {}
  /// Σ (torque/limit)² of a torque, square root.
  double load(const Vec3<double>& torque) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      sum +=
          std::pow(torque[k] / (torque[k] > 0 ? joint.dofs[k].torque_plus : joint.dofs[k].torque_minus), 2);
    return std::sqrt(sum);
  }
  /// Turns the link by a couple (N·m, world) that the muscles must answer; one step.
  bool twist(const Vec3<double>& couple, double h) {
    const Vec3<double> arm = 0.05 * couple.unitOrthogonal(),
                       force = couple.cross(arm) / (2 * arm.squaredNorm());
    const Vec3<double> at = stage.character(0).model()[1].translation.template cast<double>();
    stage.press(0, 1, at + arm, force, h);
    stage.press(0, 1, at - arm, -force, h);
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
    TwistedLink<T> link(t.scene);
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
  TwistedLink<T> link(t.scene);
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
  TwistedLink<T> link(t.scene);
  Character<T> c = link.stage.character(0);
  const Vec3<double> axis = link.joint.axis;
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
  (void)c.set_group_strength("biceps", T(0));
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
  Stage<T> stage(t.scene);
  bool on = false;
  stage.run(5, t.h, [&](double) {
    (void)stage.character(0).set_strength(T(on ? 1 : 0));
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
    scene::Scene scene = t.scene;
    scene.characters[0].strength = {{0, strength}};
    Stage<T> stage(scene);
    stage.run(4, t.h);
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
  Stage<T> stage(t.scene);
  const int elbow = t.scene.characters[0].asset->skeleton.find("forearm_l");
  const int dof = stage.character(0).first_dof(elbow);
  double torque = 0;
  stage.run(5, t.h,
            [&](double) { torque = std::max(torque, std::abs(double(stage.character(0).torque()[dof]))); });
  Verdict v(stage.measured());
  v.sound();
  v.at_most("torque (N m)", torque, 60 * (1 + 1e-5));
  v.at_most("kinetic energy at the end (J)", v.measured().kinetic_end, 1e-3);
  return v;
}

template <class T>
Verdict target_through_wall(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(5, t.h);
  Verdict v(stage.measured());
  v.sound();
  const int hand = t.scene.characters[0].asset->skeleton.find("hand_l");
  v.at_most("hand beyond the wall's face (m)", double(stage.character(0).model()[hand].translation.x()) - 0.3,
            0);
  v.at_most("kinetic energy at the end (J)", v.measured().kinetic_end, 1e-3);
  return v;
}

template <class T>
Verdict ragdoll_and_back_each_second(const Trial& t) {
  Stage<T> stage(t.scene);
  int returned = 0, cycles = 0;
  const double lasting = t.lasting(3600, 30);
  bool was_limp = false;
  stage.run(lasting, t.h, [&](double time) {
    const bool is_limp = std::fmod(time, 2) < 0.5;
    if (is_limp && !was_limp && time > 1) ++cycles, returned += stage.character(0).on_animation();
    was_limp = is_limp;
    (void)stage.character(0).set_strength(T(is_limp ? 0 : 1));
    if (is_limp)
      stage.press(0, 0, stage.character(0).model()[0].translation.template cast<double>(),
                  Vec3<double>(50, 20 * std::sin(time), 0), t.h);
  });
  Verdict v(stage.measured());
  v.sound();
  v.require(returned == cycles, "back on the animation in " + std::to_string(returned) + " of " +
                                    std::to_string(cycles) + " cycles");
  return v;
}

/// A standing figure becomes a ragdoll, root and all, falls, and gets its strength and its driven root back,
/// again and again.
template <class T>
Verdict ragdoll_and_back(const Trial& t) {
  constexpr double kCycle = 5, kLimp = 1.5;  // s
  Stage<T> stage(t.scene);
  const double mass = stage.character(0).skeleton().total_mass();
  int returned = 0, fallen = 0, cycles = 0;
  double kick = 0, lowest = 1;
  bool was_limp = false;
  Vec3<double> before = Vec3<double>::Zero();
  stage.run(t.lasting(600, 15), t.h, [&](double time) {
    const bool limp = std::fmod(time, kCycle) < kLimp;
    const Vec3<double> now = stage.books().momentum(0).linear / mass;
    // What the first limp frame changed, beyond what gravity can; its feet may still bear it.
    if (limp && !was_limp && time > 0) before = now;
    if (limp && was_limp && std::fmod(time, kCycle) < 1.5 * t.h && time > kCycle)
      kick = std::max(kick, (now - before).norm() - 9.81 * t.h);
    if (limp && !was_limp && time > 1) ++cycles, returned += stage.character(0).on_animation();
    lowest = std::min(lowest, stage.center_of_mass(0).z());
    if (!limp && was_limp) fallen += lowest < 0.5, lowest = 1;
    if (limp != was_limp) {
      (void)stage.character(0).set_root_drive(limp ? RootDrive::kFree : RootDrive::kAssisted);
      (void)stage.character(0).set_strength(T(limp ? 0 : 1));
    }
    was_limp = limp;
  });
  Verdict v(stage.measured());
  v.sound();
  v.at_least("times fallen", fallen, cycles);
  v.require(returned == cycles, "back on the animation in " + std::to_string(returned) + " of " +
                                    std::to_string(cycles) + " cycles");
  v.at_most("speed (m/s) that the first limp frame gives", kick, 0.05);  // 5 % of what it walks at
  return v;
}

template <class T>
Verdict ragdoll_hit_in_the_same_frame(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(1, t.h);
  const Skeleton& body = t.scene.characters[0].asset->skeleton;
  const int hand = body.find("hand_r"), elbow = body.find("forearm_r");
  const Vec3<double> before = stage.character(0).model()[hand].translation.template cast<double>();
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
       walk_cycle<float, 100>,
       walk_cycle<double, 100>,
       "",
       "walk_cycle"},
      {"walk_cycle_at_150_percent",
       "45",
       "seed talk, animation",
       "pose = clip to 1e-5; 95 % of the frames are playback",
       {1.0 / 60},
       walk_cycle<float, 150>,
       walk_cycle<double, 150>,
       "",
       "walk_cycle"},
      {"walk_cycle_at_200_percent",
       "45",
       "seed talk, animation",
       "pose = clip to 1e-5; 95 % of the frames are playback",
       {1.0 / 60},
       walk_cycle<float, 200>,
       walk_cycle<double, 200>,
       "",
       "walk_cycle"},
      {"walk_cycle_at_300_percent",
       "45",
       "seed talk, animation",
       "pose = clip to 1e-5; 95 % of the frames are playback",
       {1.0 / 60},
       walk_cycle<float, 300>,
       walk_cycle<double, 300>,
       "",
       "walk_cycle"},
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
      {"ragdoll_and_back",
       "53",
       "shock2quest PR #304",
       "with a free root: falls, is back every time; no kick in the first frame",
       {1.0 / 60},
       ragdoll_and_back<float>,
       ragdoll_and_back<double>,
       "",
       "ragdoll_and_back_each_second"},
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
