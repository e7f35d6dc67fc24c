// Rows 13–30: masses, stiffness, chains, redundancy.
#include <cmath>

#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

template <class T>
Verdict rope_with_heavy_tip(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(t.lasting(10, 3), t.h);
  Verdict v(stage.measured());
  v.general();
  return v;
}

template <class T>
Verdict mass_ratio_1000(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(t.lasting(10, 5), t.h);
  Verdict v(stage.measured());
  v.general();
  return v;
}

template <class T>
Verdict whip(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(3, t.h);
  Verdict v(stage.measured());
  v.general();
  return v;
}

/// The figure's pelvis after 5 s on feet of `mass` kg.
template <class T>
Vec3<double> heavy_torso(scene::Scene scene, double mass, double h, Measurement& measured) {
  Skeleton& body = skeleton_of(scene);
  for (const char* foot : {"foot_l", "foot_r"}) {
    Joint& joint = body.joints[body.find(foot)];
    joint.inertia *= mass / joint.mass;
    joint.mass = mass;
  }
  Stage<T> stage(scene);
  stage.run(5, h);
  measured.merge(stage.measured());
  return stage.character(0).model()[1].translation.template cast<double>();
}

template <class T>
Verdict light_foot(const Trial& t) {
  Measurement measured, ignored;
  double apart = 0, most = 0;
  for (const double mass : {0.001, 0.03, 1.0}) {
    Measurement one;
    const Vec3<double> found = heavy_torso<T>(t.scene, mass, t.h, one);
    most = std::max(most, one.mean_passes());
    measured.merge(one);
    if (sizeof(T) == 4)
      apart = std::max(apart, (found - heavy_torso<double>(t.scene, mass, t.h, ignored)).norm());
  }
  Verdict v(measured);
  v.general();
  v.at_most("float off double (m)", apart, 1e-2);
  v.at_most("mean passes", most, 4);
  return v;
}

template <class T>
double hinge_angle(Stage<T>& stage) {
  const Quat<double> q = stage.character(0).local()[1].rotation.template cast<double>();
  return 2 * std::atan2(q.y(), q.w());
}

template <class T>
Verdict tiny_foot(const Trial& t) {
  Measurement measured;
  double turned = 0;
  for (const bool strong : {true, false}) {
    scene::Scene scene = t.scene;
    DofLimits& muscle = skeleton_of(scene).joints[1].dofs[0];
    if (!strong) muscle.torque_minus = muscle.torque_plus = 0;
    Stage<T> stage(scene);
    stage.run(1, t.h, [&](double) {
      if (strong) turned = std::max(turned, std::abs(hinge_angle(stage)));
    });
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("foot with a muscle turned (rad)", turned, 5 * kPi / 180);
  return v;
}

/// Where a damped lever that a constant force turns comes to rest: α·h² = `ratio` at step h, taken in
/// `parts`.
template <class T>
double settled(scene::Scene scene, double ratio, double h, int parts, Measurement& measured) {
  Joint& foot = skeleton_of(scene).joints[1];
  scene::Push& push = scene.pushes[0];
  const double inertia = foot.inertia(1, 1), alpha = ratio / (h * h),
               force = alpha * inertia / push.point.x();
  foot.dofs[0].damping = 0.4 * std::sqrt(alpha) * inertia;
  push.force = {{0, {force, 0, 0}}};
  Stage<T> stage(scene);
  stage.run(2, h / parts);
  measured.merge(stage.measured());
  return hinge_angle(stage);
}

template <class T>
Verdict far_root(const Trial& t) {
  Measurement measured, ignored;
  double apart = 0;
  for (const double ratio : {0.5, 1.0, 2.0, 4.0, 8.0})
    apart = std::max(apart, std::abs(settled<T>(t.scene, ratio, t.h, 1, measured) -
                                     settled<T>(t.scene, ratio, t.h, 16, ignored)));
  Verdict v(measured);
  v.general();
  v.at_most("off the angle with 16 substeps (rad)", apart, 2 * kPi / 180);
  return v;
}

template <class T>
Verdict hand_of_no_inertia(const Trial& t) {
  Stage<T> stage(t.scene);
  double last = 0, before = 1e9;
  bool monotone = true;
  stage.run(1, t.h, [&](double time) {
    const double angle = hinge_angle(stage), moved = angle - last;
    if (time > 0) monotone = monotone && moved >= -1e-6 && moved <= before + 1e-6;
    if (time > 0) before = moved;
    last = angle;
  });
  Verdict v(stage.measured());
  v.general();
  v.at_least("angle turned (rad)", last, 1e-6);
  v.require(monotone, "the hinge's speed does not fall monotonically");
  return v;
}

template <class T>
Verdict stiff_servo(const Trial& t) {
  scene::Scene scene = t.scene;
  scene.world.accuracy.return_time = t.h / 30;  // ωₙ·h = 30
  Stage<T> stage(scene);
  double most = 0, under = 0, excess = 0;
  stage.run(3, t.h, [&](double) {
    const double angle = -hinge_angle(stage);
    most = std::max(most, angle);
    under = std::min(under, angle);
    for (const T torque : stage.character(0).torque().subspan(6))
      excess = std::max(excess, std::abs(double(torque)));
  });
  Verdict v(stage.measured());
  v.sound();
  v.at_least("excursion (rad)", most, 0.02);
  v.at_most("overshoot, share of the excursion", -under / most, 0.05);
  v.at_most("torque (N m)", excess, 20 * (1 + 1e-5));
  v.at_most("angle after 3 s (rad)", std::abs(hinge_angle(stage)), 1e-3);
  return v;
}

template <class T>
Verdict massless_inner_link(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(3, t.h);
  Skeleton body = t.scene.characters[0].asset->skeleton;
  body.joints[2].mass = 0;
  body.joints[2].inertia.setZero();
  Status status;
  World<T> other((WorldSettings()));
  other.add_character(body, passive(), status);
  Verdict v(stage.measured());
  v.general();
  v.require(!status.ok() && status.index >= 0, "a joint that moves no mass is not refused by its index");
  return v;
}

template <class T>
Verdict contact_stiffness_sweep(const Trial& t) {
  Measurement measured;
  double fewest = 1e9, most = 0;
  for (const double sink : {0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {  // 7e3 … 7e9 N/m
    scene::Scene scene = t.scene;
    scene.world.accuracy.sink_depth = sink;
    Stage<T> stage(scene);
    stage.run(t.lasting(4, 2), t.h);
    fewest = std::min(fewest, stage.measured().mean_iterations());
    most = std::max(most, stage.measured().mean_iterations());
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("mean iterations (passes and simplified Newton steps), most over fewest", most / fewest, 2);
  return v;
}

template <class T>
Verdict coplanar_contacts(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(2, t.h);
  const auto height = [&](int box) { return double(stage.character(box).model()[0].translation.z()); };
  const auto [lowest, highest] = std::minmax({height(0), height(1), height(2)});
  Verdict v(stage.measured());
  v.general();
  v.at_most("heights apart (m)", highest - lowest, 1e-4);
  return v;
}

template <class T>
Verdict limits_that_meet(const Trial& t) {
  Stage<T> stage(t.scene);
  double off = 0;
  stage.run(5, t.h, [&](double) {
    const Quat<double> q = stage.character(0).local()[1].rotation.template cast<double>();
    off = std::max(off, std::abs(2 * std::atan2(q.y(), q.w()) - 0.3));
  });
  Skeleton body = t.scene.characters[0].asset->skeleton;
  body.joints[1].dofs[0].lower = 0.3 + kPi / 180;
  Status status;
  World<T> other((WorldSettings()));
  other.add_character(body, passive(), status);
  Verdict v(stage.measured());
  v.general();
  v.at_most("off the only angle allowed (rad)", off, 0.05);
  v.require(status.index == 1, "limits that cross are not refused by the joint's index");
  return v;
}

}  // namespace

std::vector<HardCase> mass_cases() {
  return {
      {"rope_with_heavy_tip",
       "13",
       "JoltPhysics#1392; o3de#2610",
       "general",
       {1.0 / 60, 1.0 / 30},
       rope_with_heavy_tip<float>,
       rope_with_heavy_tip<double>},
      {"mass_ratio_1000_to_1",
       "figure",
       "DESIGN section 9",
       "general",
       {1.0 / 60, 1.0 / 30, 1.0 / 10},
       mass_ratio_1000<float>,
       mass_ratio_1000<double>},
      {"mass_ratio_1_to_1000",
       "figure",
       "DESIGN section 9",
       "general",
       {1.0 / 60, 1.0 / 30, 1.0 / 10},
       mass_ratio_1000<float>,
       mass_ratio_1000<double>},
      {"whip",
       "14",
       "research 1.3",
       "no more energy than the base puts in",
       {1.0 / 60, 1.0 / 30},
       whip<float>,
       whip<double>},
      {"light_foot_under_300_kg",
       "17",
       "research 1.8",
       "float as double to 1 cm, mean passes at most 4",
       {1.0 / 60},
       light_foot<float>,
       light_foot<double>},
      {"tiny_foot_2_kN",
       "18",
       "seed talk, limitations",
       "with a muscle no flip; without, no energy gained",
       {1.0 / 60},
       tiny_foot<float>,
       tiny_foot<double>},
      {"far_root_sweep",
       "19",
       "research 1.2",
       "settles where 16 substeps settle, to 2 deg",
       {1.0 / 60},
       far_root<float>,
       far_root<double>},
      {"hand_of_no_inertia",
       "20",
       "sr-ros-interface PR #200; brax#329",
       "its speed decays monotonically",
       {1.0 / 60},
       hand_of_no_inertia<float>,
       hand_of_no_inertia<double>},
      {"stiff_servo",
       "21",
       "mujoco#3443; DESIGN section 9",
       "overshoot below 5 %, torque within its limit",
       {1.0 / 60, 1.0 / 30},
       stiff_servo<float>,
       stiff_servo<double>},
      {"massless_links",
       "22",
       "mujoco DegenerateInertia",
       "inner link without mass runs; a leaf is refused",
       {1.0 / 60},
       massless_inner_link<float>,
       massless_inner_link<double>},
      {"contact_stiffness_sweep",
       "23",
       "research 1.7",
       "mean iterations vary by less than 2",
       {1.0 / 60},
       contact_stiffness_sweep<float>,
       contact_stiffness_sweep<double>},
      {"coplanar_contacts",
       "29",
       "research 1.7",
       "4, 16, 64 points rest at the same height to 0.1 mm",
       {1.0 / 60},
       coplanar_contacts<float>,
       coplanar_contacts<double>},
      {"limits_that_meet",
       "30",
       "o3de PR #5510",
       "holds the one angle; crossed limits are refused",
       {1.0 / 60},
       limits_that_meet<float>,
       limits_that_meet<double>},
  };
}

}  // namespace sinew::study
