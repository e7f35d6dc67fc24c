// Rows 1–12: rotation and integration, without contacts.
#include <cmath>

#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

template <class T>
Quat<double> attitude(Stage<T>& stage, int character = 0) {
  return stage.character(character).model()[0].rotation.template cast<double>().normalized();
}

/// Until the axis about which the box was spun points the other way, s; negative if it never does.
template <class T>
double first_flip(Stage<T>& stage, double h, double longest) {
  for (double t = h; t < longest; t += h) {
    if (!stage.step(h)) return -1;
    if ((attitude(stage) * Vec3<double>::UnitY()).y() < 0) return t;
  }
  return -1;
}

template <class T>
Verdict tennis_racket(const Trial& t) {
  Stage<double> fine(t.scene);
  const double expected = first_flip(fine, 1.0 / 480, 20);
  Stage<T> stage(t.scene);
  const double found = first_flip(stage, t.h, 20);
  const Joint& box = t.scene.characters[0].asset->skeleton.joints[0];
  const Vec3<double> momentum = box.inertia * t.scene.characters[0].speeds.spin[0].second;
  double lost = 0;
  stage.run(t.lasting(100, 20) - found, t.h, [&](double) {
    const audit::Momentum& now = stage.books().momentum_between_impacts();
    lost = std::max(lost, ((now.angular - momentum).norm() - now.angular_error) / momentum.norm());
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("first flip off the reference at 1/480 s, share", std::abs(found / expected - 1), 0.05);
  v.at_most("angular momentum lost, share", lost, 1e-4);
  return v;
}

template <class T>
Verdict slender_rod(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(10, t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("passes", v.measured().most_passes, 8);
  return v;
}

template <class T>
Verdict welded_child(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(10, t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("attitude apart (rad)", attitude(stage, 0).angularDistance(attitude(stage, 1)), 1e-4);
  return v;
}

template <class T>
Verdict hour_of_spin(const Trial& t) {
  Stage<T> stage(t.scene);
  double tilt = 0, norm = 0;
  stage.run(t.lasting(3600, 600), t.h, [&](double) {
    tilt = std::max(tilt, std::acos(std::min(1.0, (attitude(stage) * Vec3<double>::UnitZ()).z())));
    norm = std::max(norm, std::abs(double(stage.character(0).model()[0].rotation.norm()) - 1));
  });
  Verdict v(stage.measured());
  v.general();
  v.at_least("share of steps in which it was simulated", double(v.measured().solved) / v.measured().steps,
             0.99);
  v.at_most("tilt (rad)", tilt, 0.1 * kPi / 180);
  v.at_most("quaternion's norm off 1", norm, 1e-6);
  return v;
}

/// Angle (rad) between the simulated and the analytic attitude of a symmetric top after 2 s.
template <class T>
double top_error(const scene::Scene& scene, Compared scheme, double h, Measurement& measured) {
  Stage<T> stage(scene, scheme);
  stage.run(2, h);
  measured.merge(stage.measured());
  const Vec3<double> inertia = scene.characters[0].asset->skeleton.joints[0].inertia.diagonal(),
                     omega = scene.characters[0].speeds.spin[0].second;
  const Vec3<double> momentum = inertia.cwiseProduct(omega);
  const Vec3<double> spin(0, 0, omega.z() * (1 - inertia.z() / inertia.x()));
  const Quat<double> exact =
      rotation_exp<double>(momentum / inertia.x() * 2) * rotation_exp<double>(spin * 2);
  return attitude(stage).angularDistance(exact);
}

template <class T>
Verdict symmetric_top(const Trial& t) {
  Measurement measured;
  const auto order = [&](Compared scheme) {
    return std::log2(top_error<T>(t.scene, scheme, t.h, measured) /
                     top_error<T>(t.scene, scheme, t.h / 2, measured));
  };
  const double first = order(Compared::kBdf1);
  const double exact = top_error<T>(t.scene, Compared::kBossak, t.h, measured);
  Verdict v(measured);
  v.general();
  v.at_most("attitude off after 2 s (rad)", exact, 5e-3);
  v.at_most("bdf1: order off 1", std::abs(first - 1), 0.1);
  return v;
}

template <class T, int speed>
Verdict free_flight(const Trial& t) {
  scene::Scene scene = t.scene;
  scene.characters[0].speeds.random = speed;
  Stage<T> stage(scene);
  const double mass = stage.character(0).skeleton().total_mass();
  Vec3<double> before = stage.center_of_mass(0), drift = Vec3<double>::Zero(), first = drift;
  stage.run(2, t.h, [&](double time) {
    const Vec3<double> now = stage.center_of_mass(0);
    if (time > 1.5 * t.h && first.isZero()) first = (now - before) / t.h;
    if (!first.isZero()) drift = drift.cwiseMax(((now - before) / t.h - first).cwiseAbs());
    before = now;
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("largest rise in a step, share of energy", v.measured().worst_rise / v.measured().kinetic_start,
            1e-3);
  // Relative to the momentum that the limbs carry against each other, m·√(2E/m).
  v.at_most("linear momentum lost, share",
            mass * drift.norm() / std::sqrt(2 * mass * v.measured().kinetic_start), 1e-3);
  v.at_most("99th percentile of passes", v.measured().passes_percentile(0.99), 8);
  return v;
}

template <class T>
Verdict ball_hits_floating_figure(const Trial& t) {
  Stage<T> stage(t.scene);
  const PropSettings& ball = t.scene.props[0].settings;
  const double mass = stage.character(0).skeleton().total_mass();
  Vec3<double> before = stage.center_of_mass(0), momentum = Vec3<double>::Zero();
  double off = 0;
  bool touched = false;
  stage.run(3, t.h, [&](double time) {
    const Vec3<double> now = stage.center_of_mass(0);
    const CharacterReport& report = stage.character(0).report();
    touched = touched || report.contacts > 0;
    momentum =
        mass * (now - before) / t.h + ball.mass * stage.world().prop_velocity(0).template cast<double>();
    before = now;
    if (time > 1 && report.contacts == 0)
      off = std::max(off, (momentum - ball.mass * ball.velocity).norm() / (ball.mass * 5));
  });
  Verdict v(stage.measured());
  v.general();
  v.require(touched, "the ball missed");
  v.at_most("momentum lost, share", off, 1e-3);
  return v;
}

template <class T>
Verdict through_pitch_90(const Trial& t) {
  Stage<T> stage(t.scene);
  double spike = 0;
  Quat<double> before = Quat<double>::Identity();
  stage.run(4, t.h, [&](double time) {
    const Quat<double> now = stage.character(0).local()[1].rotation.template cast<double>();
    if (time > 0) spike = std::max(spike, std::abs(before.angularDistance(now) / t.h / 5 - 1));
    before = now;
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("joint speed off 5 rad/s, share", spike, 0.01);
  return v;
}

/// Torques of a ball joint whose target is held at `angle` from its rest, after a push; the same motion in
/// the world whatever the angle.
template <class T>
std::vector<double> torques_near(scene::Scene scene, double angle, double h, Measurement& measured) {
  skeleton_of(scene).joints[1].rest.rotation = rotation_exp<double>({0, -angle, 0});
  scene.characters[0].pose = {{1, {{0, {0, angle, 0}}}}};
  Stage<T> stage(scene);
  std::vector<double> torques;
  stage.run(1, h, [&](double time) {
    if (time > 0)
      for (int k = 6; k < 9; ++k) torques.push_back(double(stage.character(0).torque()[k]));
  });
  measured.merge(stage.measured());
  return torques;
}

template <class T>
Verdict joint_through_pi(const Trial& t) {
  Measurement measured;
  const std::vector<double> plain = torques_near<T>(t.scene, 0, t.h, measured);
  double apart = 0;
  for (const double angle : {kPi - 1.7e-4, kPi + 1.7e-4, -kPi + 1.7e-4}) {
    const std::vector<double> turned = torques_near<T>(t.scene, angle, t.h, measured);
    for (std::size_t i = 0; i < std::min(plain.size(), turned.size()); ++i)
      apart = std::max(apart, std::abs(plain[i] - turned[i]));
  }
  Verdict v(measured);
  v.general();
  v.at_most("torque off that of a joint far from pi (N m)", apart, 0.01 * 20);
  return v;
}

/// Local pose of a limp figure after a second of flight that began with its root turned by `turn`.
template <class T>
std::vector<Transform<T>> flown(scene::Scene scene, const Vec3<double>& turn, double h,
                                Measurement& measured) {
  // Asks about the frame, not about the solver.
  scene.world.accuracy.tolerance = sizeof(T) == 8 ? 1e-8 : 1e-6;
  scene.characters[0].pose = {{0, {{0, turn}}}};
  Stage<T> stage(scene);
  stage.run(1, h);
  measured.merge(stage.measured());
  const auto local = stage.character(0).local();
  return {local.begin(), local.end()};
}

template <class T>
Verdict root_turned_by_pi(const Trial& t) {
  Measurement measured;
  const auto plain = flown<T>(t.scene, Vec3<double>::Zero(), t.h, measured);
  double apart = 0;
  for (const Vec3<double>& axis : {Vec3<double>(1, 0, 0), Vec3<double>(0, 1, 0), Vec3<double>(0.6, 0, 0.8)}) {
    const auto turned = flown<T>(t.scene, axis * kPi, t.h, measured);
    for (std::size_t i = 1; i < plain.size(); ++i)
      apart = std::max(apart, double(plain[i].rotation.angularDistance(turned[i].rotation)));
  }
  Verdict v(measured);
  v.general();
  v.at_most("joint angles apart (rad)", apart, sizeof(T) == 4 ? 1e-3 : 1e-4);  // float's rounding, 1 s
  return v;
}

/// Tip of the pendulum after `seconds`.
Vec3<double> swing(const scene::Scene& scene, double h, double seconds, Measurement& measured) {
  Stage<double> stage(scene);
  stage.run(seconds, h);
  measured.merge(stage.measured());
  measured.kinetic_end = stage.measured().kinetic_end;
  return stage.character(0).model()[4] * Vec3<double>(0, 0, -1);
}

Verdict five_bar_pendulum(const Trial& t) {
  Measurement measured, ignored;
  const Vec3<double> exact = swing(t.scene, 1.0 / 3840, 0.5, ignored);
  const double coarse = (swing(t.scene, t.h, 0.5, measured) - exact).norm();
  const double fine = (swing(t.scene, t.h / 2, 0.5, measured) - exact).norm();
  const double halved = (swing(t.scene, t.h, 1, measured) - swing(t.scene, t.h / 2, 1, measured)).norm();
  Verdict v(measured);
  v.general();
  v.at_least("order", std::log2(coarse / fine), 1.7);
  v.at_most("tip at 1 s moved by halving h, share of the length", halved / 5, 0.05);
  return v;
}

/// End of the second rod after 100 steps of `h` in `parts` each.
template <class T>
Vec3<double> two_hinges(const scene::Scene& scene, double h, int parts, Measurement& measured) {
  Stage<T> stage(scene);
  stage.run(100 * h, h / parts);
  measured.merge(stage.measured());
  return (stage.character(0).model()[1] * Vec3<T>(0, 0, T(-0.5))).template cast<double>();
}

template <class T>
Verdict orthogonal_hinges(const Trial& t) {
  Measurement measured, ignored;
  const Vec3<double> exact = two_hinges<double>(t.scene, t.h, 16, ignored);
  const Vec3<double> found = two_hinges<T>(t.scene, t.h, 1, measured);
  Verdict v(measured);
  v.general();
  v.require(v.measured().solved > 0, "was not simulated");
  v.at_most("end off the reference (m)", (found - exact).norm(), 1e-3);
  return v;
}

}  // namespace

std::vector<HardCase> rotation_cases() {
  return {
      {"tennis_racket",
       "1",
       "mujoco FreeBodyGyroStable; bullet3 PR #346",
       "first flip within 5 % of 1/480 s; angular momentum to 1e-4",
       {1.0 / 60, 1.0 / 30},
       tennis_racket<float>,
       tennis_racket<double>},
      {"slender_rod_240_rad_s",
       "2",
       "avian#420",
       "at most 8 passes",
       {1.0 / 60},
       slender_rod<float>,
       slender_rod<double>},
      {"welded_child",
       "3",
       "mujoco#3553",
       "same attitude to 1e-4 rad after 10 s",
       {1.0 / 60},
       welded_child<float>,
       welded_child<double>},
      {"hour_of_spin",
       "4",
       "mujoco NormalizeQuats; avian#993",
       "tilt below 0.1 deg, quaternion norm 1 +- 1e-6",
       {1.0 / 60},
       hour_of_spin<float>,
       hour_of_spin<double>},
      {"symmetric_top",
       "5",
       "drake free_rotating_body_test",
       "exact; bdf1 of order 1",
       {1.0 / 60},
       symmetric_top<float>,
       symmetric_top<double>},
      {"free_flight_1_rad_s",
       "6",
       "research 1.3",
       "no step gains 0.1 %, momentum to 1e-3, p99 of passes 8",
       {1.0 / 240, 1.0 / 60, 1.0 / 30},
       free_flight<float, 1>,
       free_flight<double, 1>,
       "",
       "free_flight"},
      {"free_flight_3_rad_s",
       "6",
       "research 1.3",
       "no step gains 0.1 %, momentum to 1e-3, p99 of passes 8",
       {1.0 / 240, 1.0 / 60, 1.0 / 30},
       free_flight<float, 3>,
       free_flight<double, 3>,
       "",
       "free_flight"},
      {"free_flight_10_rad_s",
       "6",
       "research 1.3",
       "no step gains 0.1 %, momentum to 1e-3, p99 of passes 8",
       {1.0 / 240, 1.0 / 60, 1.0 / 30},
       free_flight<float, 10>,
       free_flight<double, 10>,
       "",
       "free_flight"},
      {"free_flight_30_rad_s",
       "6",
       "research 1.3",
       "no step gains 0.1 %, momentum to 1e-3, p99 of passes 8",
       {1.0 / 240, 1.0 / 60, 1.0 / 30},
       free_flight<float, 30>,
       free_flight<double, 30>,
       "",
       "free_flight"},
      {"ball_hits_floating_figure",
       "7",
       "SimBenchmark anymal-momentum",
       "momentum of both kept to 1e-3",
       {1.0 / 60},
       ball_hits_floating_figure<float>,
       ball_hits_floating_figure<double>},
      {"through_pitch_90",
       "8",
       "PhysX#323; Modia3D PR #21",
       "joint speed within 1 %",
       {1.0 / 60},
       through_pitch_90<float>,
       through_pitch_90<double>},
      {"joint_through_pi",
       "9",
       "webots PR #6118; Jolt ConstraintSingularityTest",
       "torque as far from pi, to 1 % of the limit",
       {1.0 / 60},
       joint_through_pi<float>,
       joint_through_pi<double>},
      {"root_turned_by_pi",
       "10",
       "gazebo-classic#1487; dart PR #1437",
       "same joint angles to 1e-4 rad",
       {1.0 / 60},
       root_turned_by_pi<float>,
       root_turned_by_pi<double>},
      {"five_bar_pendulum",
       "11",
       "seed paper section 4",
       "order at least 1.7; halving h moves the tip < 5 % at 1 s",
       {1.0 / 60},
       nullptr,
       five_bar_pendulum},
      {"orthogonal_hinges",
       "12",
       "mujoco_warp PR #1663",
       "tracks the reference for 100 steps to 1 mm",
       {1.0 / 1000},
       orthogonal_hinges<float>,
       orthogonal_hinges<double>},
  };
}

}  // namespace sinew::study
