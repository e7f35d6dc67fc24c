// The talk up to its Jacobians, and its closed loops.
#include <numbers>

#include "study/talk/judges.h"

namespace sinew::study {
namespace {

using scene::Scene;

// ---- "Forward Euler", "Implicit Euler": a weight of 1 kg on a spring of 900 N/m, 1.5 m/s at first

constexpr double kOmega = 30, kFirstSpeed = 1.5;  ///< rad/s, m/s

struct Oscillator {
  double x = 0, v = kFirstSpeed;
  void forward(double h) {
    const double a = -kOmega * kOmega * x;
    x += h * v;
    v += h * a;
  }
  void implicit(double h) {
    v = (v - h * kOmega * kOmega * x) / (1 + h * h * kOmega * kOmega);
    x += h * v;
  }
};

double weight_at(const Played& played, int frame) {
  return double(joint_at(played, frame, 0, 0).translation.x());
}

/// m, furthest off the scheme written out by hand.
double off_by_hand(const Played& played, void (Oscillator::*step)(double)) {
  Oscillator exact;
  double most = 0;
  for (int f = 0; f < played.judge().frames(); ++f) {
    most = std::max(most, std::abs(weight_at(played, f) - exact.x));
    (exact.*step)(played.judge().step());
  }
  return most;
}

/// m, largest over the last half period.
double amplitude_at_end(const Played& played) {
  const int end = played.judge().frames() - 1;
  const int half = static_cast<int>(std::ceil(std::numbers::pi / kOmega / played.judge().step()));
  return played.judge().worst(end - half, end, [&](int f) { return std::abs(weight_at(played, f)); });
}

void stiff_spring(const Scene& scene, bool, Findings& found) {
  const Played forward(by_scheme(scene, Compared::kForwardEuler)),
      semi(by_scheme(scene, Compared::kSemiImplicit)), implicit(by_scheme(scene, Compared::kBdf1)),
      bossak(by_scheme(scene, Compared::kBossak));
  for (const Played* played : {&forward, &semi, &implicit, &bossak}) found.sound(*played, 0);
  if (!found.refused().empty()) return;
  double apart = 0;
  for (int f = 0; f < semi.judge().frames(); ++f)
    apart = std::max(apart, std::abs(weight_at(semi, f) - weight_at(implicit, f)));
  // Recordings are in float, of up to a few metres.
  found.at_most("forward Euler off its formula (m)", off_by_hand(forward, &Oscillator::forward), 1e-4);
  found.at_most("implicit Euler off its formula (m)", off_by_hand(implicit, &Oscillator::implicit), 1e-6);
  found.at_most("semi-implicit off implicit Euler (m)", apart, 1e-6);
  const double first = kFirstSpeed / kOmega;
  found.at_least("amplitude after 0.6 s, forward Euler (of the first)", amplitude_at_end(forward) / first,
                 10);
  found.at_most("the same, implicit Euler", amplitude_at_end(implicit) / first, 0.1);
  found.at_most("amplitude gained by the runtime's scheme", amplitude_at_end(bossak) / first, 1.001);
  found.at_least("amplitude kept by the runtime's scheme", amplitude_at_end(bossak) / first, 0.9);
}

// ---- "Constrained Rigid Body": the rod of 1 m from the horizontal

/// rad/s², of the rod when it is level.
double level_acceleration(const Scene& scene) {
  const Joint& rod = scene.characters[0].asset->skeleton.joints[0];
  const double arm = rod.center_of_mass.norm();
  return rod.mass * arm * scene.world.gravity.norm() / (rod.inertia(1, 1) + rod.mass * arm * arm);
}

/// rad, from hanging, at every frame of a run; Runge–Kutta of fourth order in steps of at most 0.1 ms.
std::vector<double> pendulum_angles(const Scene& scene, int frames) {
  const double level = level_acceleration(scene);
  const auto turned = [&](double q) { return -level * std::sin(q); };
  const int parts = static_cast<int>(std::ceil(1e4 / scene.frame_rate));
  const double h = 1 / scene.frame_rate / parts;
  double q = std::numbers::pi / 2, v = 0;
  std::vector<double> out{q};
  for (int n = 1; n <= (frames - 1) * parts; ++n) {
    const double a1 = turned(q), v2 = v + h / 2 * a1, a2 = turned(q + h / 2 * v), v3 = v + h / 2 * a2,
                 a3 = turned(q + h / 2 * v2), v4 = v + h * a3, a4 = turned(q + h * v3);
    q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (n % parts == 0) out.push_back(q);
  }
  return out;
}

/// m, furthest that the rod's end is off in the whole run.
double tip_off(const Scene& scene, Findings& found) {
  const Played played(scene);
  found.sound(played, 1);
  if (!found.refused().empty()) return 0;
  const std::vector<double> angles = pendulum_angles(scene, played.judge().frames());
  return played.judge().worst(0, played.judge().frames() - 1, [&](int f) {
    const double q = angles[static_cast<std::size_t>(f)];
    const Eigen::Vector3d wanted(-std::sin(q), 0, 1.4 - std::cos(q));
    return (point_at(played, f, 0, 0, {0, 0, -1}) - wanted).norm();
  });
}

void hinge(const Scene& scene, bool, Findings& found) {
  Scene fine = scene;
  fine.frame_rate = 240;
  const double at_60 = tip_off(scene, found), at_240 = tip_off(fine, found);
  found.at_most("tip off the exact pendulum in 4 s, 60 Hz (m)", at_60, 0.05);
  found.at_least("order, from 60 to 240 Hz", std::log2(at_60 / at_240) / 2, 1.8);
  found.note("tip off with implicit Euler, 60 Hz (m)", tip_off(by_scheme(scene, Compared::kBdf1), found));
}

// ---- "Linked Bodies"

void linked_bodies(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 1);
  if (!found.refused().empty()) return;
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  const Eigen::Vector3d from = judge.center_of_mass(0, 0), to = judge.center_of_mass(end, 0);
  found.at_most(
      "centre of mass off its straight way (m)",
      judge.worst(0, end,
                  [&](int f) {
                    return (judge.center_of_mass(f, 0) - (from + (to - from) * (double(f) / end))).norm();
                  }),
      1e-5);
  const auto& rows = played.telemetry.rows;
  const Vec3<double> first = rows[1].report.angular_momentum;
  double turned = 0;
  for (std::size_t n = 1; n < rows.size(); ++n)
    turned = std::max(turned, (rows[n].report.angular_momentum - first).norm());
  found.at_most("angular momentum lost or turned (of it)", turned / first.norm(), 1e-5);
}

// ---- "Closed loops require constraints"

/// m, furthest that a hand's grip is from where it holds the bar.
double hands_off_bar(const Played& played, const Scene& scene) {
  return played.judge().worst(1, played.judge().frames() - 1, [&](int f) {
    double off = 0;
    for (const LoopSettings& loop : scene.loops)
      off = std::max(
          off,
          (point_at(played, f, 0, loop.a.joint, loop.a.frame.translation) - loop.b.frame.translation).norm());
    return off;
  });
}

/// J, most that a figure ever has beyond what it began with.
double energy_gained(const Played& played, const Scene& scene) {
  const Judge judge = played.judge();
  const double mass = scene.characters[0].asset->skeleton.total_mass(), g = scene.world.gravity.norm();
  const double speed = scene.characters[0].speeds.velocity.norm();
  const double first = 0.5 * mass * speed * speed + mass * g * judge.center_of_mass(0, 0).z();
  return judge.worst(1, judge.frames() - 1, [&](int f) {
    const double height = (judge.center_of_mass(f, 0).z() + judge.center_of_mass(f - 1, 0).z()) / 2;
    return judge.kinetic(f, 0) + mass * g * height - first;
  });
}

void bar(const Scene& scene, bool, Findings& found) {
  Scene fine = scene;
  fine.frame_rate = 240;  // elbows whip: differences of poses at 60 Hz do not resolve their speed
  const Played played(scene), resolved(fine);
  for (const Played* p : {&played, &resolved}) found.sound(*p, 5e-3);
  if (!found.refused().empty()) return;
  found.at_most("hands off the bar (m)", hands_off_bar(played, scene), 1e-3);
  found.at_most("energy gained at 240 Hz (J)", energy_gained(resolved, scene), 1);
  found.at_least(
      "its feet swing forwards (m)",
      played.judge().worst(0, played.judge().frames() - 1,
                           [&](int f) {
                             return point_at(played, f, 0, joint_named(scene, 0, "foot_l"), {0, 0, 0}).x();
                           }),
      0.2);
}

void handcuffs(const Scene& scene, bool, Findings& found) {
  const auto hands_apart = [&](const Played& played) {
    return played.judge().worst(0, played.judge().frames() - 1, [&](int f) {
      return (point_at(played, f, 0, joint_named(scene, 0, "hand_l"), {0, 0, 0}) -
              point_at(played, f, 0, joint_named(scene, 0, "hand_r"), {0, 0, 0}))
          .norm();
    });
  };
  Scene without = scene;
  without.loops.clear();
  const Played cuffed(scene), loose(without);
  found.sound(cuffed, 5e-3);
  found.sound(loose, 5e-3);
  if (!found.refused().empty()) return;
  found.at_most("hands apart, with a chain of 0.4 m (m)", hands_apart(cuffed), 0.401);
  found.at_least("the same without it (m)", hands_apart(loose), 0.8);
  double load = 0;
  for (const scene::TelemetryRow& row : cuffed.telemetry.rows)
    if (row.limit > 0) load = std::max(load, std::abs(row.torque) / row.limit);
  found.at_most("most that a muscle gives (of its limit)", load, 1 + 1e-4);
}

// ---- "Finding the wrong root"

/// rad, that each lever has turned from upright after the first step.
double first_turn(const Played& played, int lever) {
  const Eigen::Vector3d tip =
      joint_at(played, 1, lever, 0).rotation.cast<double>() * Eigen::Vector3d::UnitZ();
  return std::atan2(std::abs(tip.x()), tip.z());
}

void wrong_root(const Scene& scene, bool, Findings& found) {
  Scene fine = scene;
  fine.frame_rate = 600;
  const Played euler(by_scheme(scene, Compared::kBdf1)), bossak(scene),
      euler_fine(by_scheme(fine, Compared::kBdf1));
  for (const Played* played : {&euler, &bossak, &euler_fine}) found.sound(*played, 1);
  if (!found.refused().empty()) return;
  // In truth they turn to 0.013, 0.018 and 0.038 rad in a sixtieth of a second: 0.01 cosh(h √a).
  found.at_most("implicit Euler, 1800 rad/s²: turns in a step (rad)", first_turn(euler, 0), 0.1);
  found.at_least("implicit Euler, 5400 rad/s²: turns in a step (rad)", first_turn(euler, 1), 0.5);
  found.at_least("implicit Euler, 14400 rad/s²: turns in a step (rad)", first_turn(euler, 2), 0.5);
  found.at_most("the runtime's scheme, 1800 rad/s² (rad)", first_turn(bossak, 0), 0.1);
  found.at_most("the runtime's scheme, 5400 rad/s² (rad)", first_turn(bossak, 1), 0.1);
  found.at_least("the runtime's scheme, 14400 rad/s² (rad)", first_turn(bossak, 2), 0.5);
  for (const Played* played : {&euler, &bossak})
    found.at_most("14400 rad/s² with a muscle (rad)", first_turn(*played, 3), 0.0101);
  found.at_most("implicit Euler, 14400 rad/s² at 600 Hz (rad)", first_turn(euler_fine, 2), 0.1);
}

}  // namespace

std::vector<Situation> talk_mechanisms() {
  return {
      {"stiff_spring", "forward Euler gains, implicit Euler loses; on a spring semi-implicit is implicit",
       stiff_spring, "talk"},
      {"hinge", "one degree of freedom: a rod swings as it should", hinge, "talk"},
      {"linked_bodies", "two bodies in flight keep their momenta", linked_bodies, "talk"},
      {"bar", "hands stay on the bar", bar, "talk"},
      {"handcuffs", "a chain holds what an animation would spread", handcuffs, "talk"},
      {"wrong_root", "a step goes wrong where it meets 3600 rad/s², a muscle helps", wrong_root, "talk"},
  };
}

}  // namespace sinew::study
