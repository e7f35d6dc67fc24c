// The talk's characters: what is solved when, what limits do, what strength, contacts and baking are worth.
#include <numbers>

#include "study/talk/judges.h"

namespace sinew::study {
namespace {

using scene::Scene;

/// Most of a column of the telemetry over the frames from `from` to `to` seconds, of one character.
template <class Of>
double most_of(const Played& played, double from, double to, int character, Of of) {
  double most = 0;
  for (const scene::TelemetryRow& row : played.telemetry.rows)
    if (row.character == character && row.time > from - 1e-9 && row.time < to + 1e-9)
      most = std::max(most, double(of(row)));
  return most;
}

double unknowns_in(const Played& played, double from, double to) {
  return most_of(played, from, to, 0, [](const scene::TelemetryRow& row) { return row.report.unknown_dofs; });
}

double torque_share(const Played& played) {
  return most_of(played, 0, 1e9, 0, [](const scene::TelemetryRow& row) {
    return row.limit > 0 ? std::abs(row.torque) / row.limit : 0;
  });
}

/// m, furthest that any joint is from where it was at the start.
double off_start(const Played& played, int frame) {
  double most = 0;
  const auto& start = played.recording.frames[0].characters[0].model;
  for (std::size_t j = 0; j < start.size(); ++j) {
    const auto& now = played.recording.frames[static_cast<std::size_t>(frame)].characters[0].model[j];
    most = std::max(most, double((now.translation - start[j].translation).norm()));
  }
  return most;
}

// ---- "Character Example"

void figure(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  if (!found.refused().empty()) return;
  const Skeleton& skeleton = scene.characters[0].asset->skeleton;
  const int dofs = played.telemetry.rows.back().report.dofs;
  found.at_most("frames that are not 14", std::abs(skeleton.body_count - 14), 0);
  found.at_most("degrees of freedom that are not 37", std::abs(dofs - 37), 0);
  found.at_most("unknowns of any step", unknowns_in(played, 0, scene.duration), 0);
  const int end = played.judge().frames() - 1;
  found.at_least("furthest that a joint goes (m)", off_start(played, end / 2), 0.3);
  found.at_most("off where it began, in the end (m)", off_start(played, end), 1e-6);
}

// ---- "Animation", "Semi Implicit vs Fully Implicit"

constexpr double kOverloaded = 2.27;  ///< s, when the pull is more than 70 N m at the shoulder

/// m/s, of the fastest body over the last half second.
double unrest(const Played& played) {
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  return judge.worst(judge.frame_at(judge.step() * end - 0.5), end, [&](int f) { return judge.fastest(f); });
}

/// m, furthest that any joint is off its place in another run, on frames of both.
double off_run(const Played& played, const Played& truth) {
  const int ratio = static_cast<int>(std::lround(truth.recording.frame_rate / played.recording.frame_rate));
  double most = 0;
  for (int f = 0; f < played.judge().frames(); ++f)
    for (std::size_t j = 0; j < played.recording.frames[0].characters[0].model.size(); ++j)
      most = std::max(most, double((joint_at(played, f, 0, static_cast<int>(j)).translation -
                                    joint_at(truth, f * ratio, 0, static_cast<int>(j)).translation)
                                       .norm()));
  return most;
}

void torque_limit(const Scene& scene, bool quick, Findings& found) {
  Scene fine = by_scheme(scene, Compared::kBdf1);
  fine.frame_rate = quick ? 480 : 960;
  const Played runtime(scene), implicit(by_scheme(scene, Compared::kBdf1)),
      semi(by_scheme(scene, Compared::kSemiImplicit)), truth(fine);
  for (const Played* played : {&runtime, &implicit, &truth}) found.sound(*played, 5e-3);
  if (!found.refused().empty()) return;
  found.at_most("unknowns while the shoulder bears the load", unknowns_in(runtime, 0, kOverloaded - 0.02), 0);
  found.at_least("unknowns when it does not", unknowns_in(runtime, kOverloaded, 3), 3);
  found.at_most("most torque (of its limit)", torque_share(runtime), 1 + 1e-5);
  found.at_most("off the animation in the end (m)", off_start(runtime, runtime.judge().frames() - 1), 1e-6);
  found.at_most("implicit Euler off its fine steps (m)", off_run(implicit, truth), 0.1);
  found.at_least("semi-implicit Euler off them (m)", off_run(semi, truth), 0.3);
  found.at_most("fastest in the last half second, implicit Euler (m/s)", unrest(implicit), 0.01);
  found.at_least("the same, semi-implicit Euler (m/s)", unrest(semi), 1);
}

// ---- "If the residual is >= this limit … the DOF is switched to dynamic"

void one_axis(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 1);
  if (!found.refused().empty()) return;
  const Judge judge = played.judge();
  Eigen::Vector3d most = Eigen::Vector3d::Zero();  // rad, about each axis
  for (int f = 0; f < judge.frames(); ++f) {
    const Eigen::AngleAxisd turn(joint_at(played, f, 0, 1).rotation.cast<double>());
    most = most.cwiseMax((turn.angle() * turn.axis()).cwiseAbs());
  }
  found.at_least("turned about the axis that is overloaded (rad)", most.y(), 0.3);
  // A muscle that is not overloaded is off its target by the rounding of its kink, 1e-3 rad/s, and the way
  // back keeps that for 0.1 s: 1e-4 rad, in steps of 1/60 s a tenth more.
  found.at_most("about those that are not (rad)", std::max(most.x(), most.z()), 1.1e-4);
  found.at_most("unknowns while its muscles bear the load", unknowns_in(played, 0, 0.6), 0);
  found.at_most("unknowns that are not 3 when one does not", std::abs(unknowns_in(played, 0.7, 1.2) - 3), 0);
  found.at_most("most torque (of its limit)", torque_share(played), 1 + 1e-5);
  found.at_most("off the animation in the end (m)", off_start(played, judge.frames() - 1), 1e-6);
}

// ---- "Semi implicit Euler … will not handle unilateral constraints … collisions, friction"

void stiff_contact(const Scene& scene, bool, Findings& found) {
  const Played runtime(scene), implicit(by_scheme(scene, Compared::kBdf1)),
      semi(by_scheme(scene, Compared::kSemiImplicit)), forward(by_scheme(scene, Compared::kForwardEuler));
  for (const Played* played : {&runtime, &implicit}) found.sound(*played, 5e-3);
  if (!found.refused().empty()) return;
  const auto most = [](const Played& played) {
    const Judge judge = played.judge();
    return judge.worst(1, judge.frames() - 1, [&](int f) { return judge.kinetic(f, 0); });
  };
  const double fallen = 0.5 * 20 * 9 + 20 * 9.81 * 0.6;  // J, that there are
  found.at_most("kinetic energy of what there is, the runtime's scheme", most(runtime) / fallen, 1);
  found.at_most("the same, implicit Euler", most(implicit) / fallen, 1);
  found.at_least("the same, semi-implicit Euler", most(semi) / fallen, 10);
  found.at_least("the same, forward Euler", most(forward) / fallen, 10);
  found.at_most("fastest in the last half second, the runtime's scheme (m/s)", unrest(runtime), 0.01);
  found.at_most("the same, implicit Euler (m/s)", unrest(implicit), 0.01);
  found.at_least("the same, semi-implicit Euler (m/s)", unrest(semi), 0.3);
}

// ---- "Limitations"

void calves(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  if (!found.refused().empty()) return;
  const int end = played.judge().frames() - 1;
  found.at_least("chest of the strong one in the end (m)",
                 double(joint_at(played, end, 0, 0).translation.z()), 1.35);
  found.at_most("chest of the weak one (m)", double(joint_at(played, end, 1, 0).translation.z()), 0.5);
}

void limp(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  if (!found.refused().empty()) return;
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  found.at_most("unknowns while it is strong", unknowns_in(played, 0, 0.49), 0);
  found.at_least("unknowns when it is limp", unknowns_in(played, 0.52, 0.6), 37);
  found.at_most("centre of mass in the end (m)", judge.center_of_mass(end, 0).z(), 0.3);
  const double mass = scene.characters[0].asset->skeleton.total_mass();
  const double start = mass * 9.81 * judge.center_of_mass(0, 0).z();
  found.at_most("energy gained (J)",
                judge.worst(1, end,
                            [&](int f) {
                              const double height =
                                  (judge.center_of_mass(f, 0).z() + judge.center_of_mass(f - 1, 0).z()) / 2;
                              return judge.kinetic(f, 0) + mass * 9.81 * height - start;
                            }),
                1);
}

// ---- "Kinematics": "Bake"

/// What baking the hands of the second figure changes.
struct BakedHands {
  double off = 0;       ///< deg, rms over time that they are turned from those of the first
  double left_out = 0;  ///< of the steps in which the first's are solved for
};

BakedHands bake(const Scene& scene, double decay, Findings& found) {
  Scene made = scene;
  made.world.detail.baked_decay = decay;
  const Played played(made);
  found.sound(played, 5e-3);
  if (!found.refused().empty()) return {};
  BakedHands out;
  double squares = 0;
  int terms = 0;
  for (int f = 0; f < played.judge().frames(); ++f)
    for (const char* name : {"hand_l", "hand_r"}) {
      const int hand = joint_named(scene, 0, name);
      const double off = double(
          joint_at(played, f, 0, hand).rotation.angularDistance(joint_at(played, f, 1, hand).rotation));
      squares += off * off;
      ++terms;
    }
  out.off = std::sqrt(squares / terms) * 180 / std::numbers::pi;
  int baked = 0, steps = 0;
  for (const scene::TelemetryRow& row : played.telemetry.rows) {
    if (row.character == 1) baked += row.report.baked;
    if (row.character == 0 && row.report.unknown_dofs >= 6) steps += 2;
  }
  out.left_out = double(baked) / steps;
  return out;
}

Scene struck_harder(Scene scene) {
  for (scene::Push& push : scene.pushes) push.impulse *= 5;
  return scene;
}

void baked(const Scene& scene, bool, Findings& found) {
  const BakedHands own = bake(scene, 0, found), hard = bake(struck_harder(scene), 0, found);
  if (!found.refused().empty()) return;
  found.at_most("hands off those always solved for, rms (deg)", own.off, 3);
  found.at_least("left out of the solves (of those with limp hands)", own.left_out, 0.6);
  found.note("after blows five times as hard, rms (deg)", hard.off);
}

/// The talk's law beside it: the best that any k makes of it.
void baked_as_in_the_talk(const Scene& scene, bool, Findings& found) {
  double best = 1e9, best_hard = 1e9;
  for (const int decay : {1, 2, 8, 32, 128}) {
    const BakedHands hands = bake(scene, decay, found), hard = bake(struck_harder(scene), decay, found);
    if (!found.refused().empty()) return;
    found.note(("with k = " + std::to_string(decay) + " 1/s, rms (deg)").c_str(), hands.off);
    best = std::min(best, hands.off);
    best_hard = std::min(best_hard, hard.off);
  }
  found.at_least("hands off those always solved for, rms, best k (deg)", best, 3);
  found.note("after blows five times as hard, best k (deg)", best_hard);
}

}  // namespace

std::vector<Situation> talk_characters() {
  return {
      {"figure", "14 frames, 37 degrees of freedom, and none to solve for", figure, "talk"},
      {"torque_limit", "a muscle gives its limit and no more; semi-implicit Euler misses when", torque_limit,
       "talk"},
      {"one_axis", "what other axes can bear stays where the animation has it", one_axis, "talk"},
      {"stiff_contact", "semi-implicit Euler misses contacts and friction", stiff_contact, "talk"},
      {"calves", "strong calves stand, weak ones do not", calves, "talk"},
      {"limp", "all at once is solved for, and comes to rest", limp, "talk"},
      {"baked", "wrists that are baked by their own equations go as if they were not", baked, "talk"},
      {"baked_as_in_the_talk", "the talk's law leaves them behind", baked_as_in_the_talk, "talk"},
  };
}

}  // namespace sinew::study
